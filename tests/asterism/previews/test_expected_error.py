"""The error that a preview states depends on the kind of its sheet, and on nothing that is computed."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from asterism.previews.shown_shape import FREE, HEAVY, HELD_FEW, HELD_MANY, ExpectedError, expected_error
from tests.asterism.previews.laws import plain_law

FEW = {"stars": {"length_mm": 8.0, "thickness_mm": 0.3}, "border": {"rings": 1}}
CORNERS = {"where": "corners", "scale": 0.8}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sections", "expected"),
    [
        ({}, FREE),
        ({"pins": [{"where": "corners", "slide": "plane"}]}, FREE),  # as free as one without supports
        ({"pins": [CORNERS]}, HELD_FEW),
        ({"pins": [CORNERS], "border": {"rings": 3}}, HELD_MANY),
        ({"pins": [CORNERS], "gravity": {"on": True}, "fabric": {"modulus_mpa": 7.1875}}, HEAVY),
        ({"stars": FEW["stars"] | {"thickness_mm": 0.9}}, None),
    ],
)
def test_the_kind_of_a_sheet_gives_its_error(sections: dict[str, Any], expected: ExpectedError | None) -> None:
    preview = Preview(Design.from_dict(FEW | sections), plain_law())
    assert expected_error(preview.state) is expected
    shape = preview.shape()
    if expected is None:
        assert shape.summary["expected_rms_percent"] is None and shape.summary["expected_height_percent"] is None
    else:
        assert shape.summary["expected_rms_percent"] == expected.distance
        height = 0.01 * shape.summary["expected_height_percent"] * shape.height_mm
        assert height == pytest.approx(0.01 * expected.height * shape.summary["diameter_mm"])
