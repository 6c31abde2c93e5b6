"""Each part of the model of the preview can be turned off."""

from __future__ import annotations

import numpy as np
import pytest

import asterism.previews.sheet as sheets
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.previews.model import PREVIEW_MODEL, without
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


@pytest.mark.parametrize("part", ALWAYS)
def test_a_part_that_is_turned_off_changes_a_free_sheet(part: str) -> None:
    design = Design.from_dict(FREE)
    on, off = (Preview(design, plain_law(), model=model) for model in (PREVIEW_MODEL, without(part)))
    points = np.vstack([on.sheet.layout.arm_tip, 0.99 * on.sheet.layout.outline])
    assert np.abs(on.at(points).bumpy - off.at(points).bumpy).max() > 1e-6


def test_an_edit_keeps_the_model() -> None:
    model = without("arms into free rims")
    preview = Preview(Design.from_dict(FREE), plain_law(), model=model)
    preview.update(Design.from_dict(FREE | {"border": {"rings": 1}}))
    assert preview.sheet.model is model


def test_a_preview_lays_out_its_design_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """And not at all if it is given the layout; an edit once more."""
    count = []
    monkeypatch.setattr(sheets, "layout", lambda design: count.append(design) or layout(design))
    dome = gallery.load("dome")
    preview = Preview(dome, plain_law())
    preview.shape()
    assert len(count) == 1
    preview.update(Design.from_dict(dome.to_dict() | {"border": {"rings": 2}}))
    assert len(count) == 2
    Preview(dome, plain_law(), plan=layout(dome)).shape()
    assert len(count) == 2
