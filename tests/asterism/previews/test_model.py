"""Each part of the model of the preview can be turned off."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.previews.fields.sheet_fields import PARTS, without
from asterism.previews.session import Preview
from tests.asterism.previews.laws import plain_law

# parts that act on a free sheet; others need supports, holes or stars of other kinds
ALWAYS = [
    "rosette metric",
    "Gaussian curvature",
    "roll axis",
    "arms into free rims",
    "bumps",
    "arms that keep their length",
]
FREE = {
    "stars": {"length_mm": {"profile": "radial", "from": 6.0, "to": 12.0, "over_mm": 40.0}, "thickness_mm": 0.35},
    "border": {"rings": 2},
    "mesh": {"edge_mm": 4.0},
}


@cache
def whole() -> Preview:
    return Preview(Design.from_dict(FREE), plain_law())


@pytest.mark.parametrize("part", ALWAYS)
def test_a_part_that_is_turned_off_changes_a_free_sheet(part: str) -> None:
    on, off = whole(), Preview(Design.from_dict(FREE), plain_law(), model=without(part))
    points = np.vstack([on.sheet.layout.arm_tip, 0.99 * on.sheet.layout.outline])
    assert np.abs(on.at(points).bumpy - off.at(points).bumpy).max() > 1e-6


def test_parts_are_turned_off_by_their_names() -> None:
    assert [without(part).off for part in PARTS] == [(part,) for part in PARTS]
    with pytest.raises(KeyError):
        without("roll axes")


def test_an_edit_keeps_the_model() -> None:
    model = without("arms into free rims")
    preview = Preview(Design.from_dict(FREE), plain_law(), model=model)
    preview.update(Design.from_dict(FREE | {"border": {"rings": 1}}))
    assert preview.sheet.model is model
