"""Pins that are further apart than in the print, or leave the sheet to swing, are told."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.shape.pin_warnings import held_wide, pin_warnings

CORNERS = [[-30.0, 0.0], [30.0, 0.0]]


@pytest.mark.parametrize(
    ("pins", "times"),
    [
        ([{"where": "border", "scale": 2.0}], "2 times"),
        ([{"where": "corners", "scale": 1.2}], "1.2 times"),
        ([{"points_mm": CORNERS, "target_mm": [[-45.0, 0.0, 0.0], [45.0, 0.0, 0.0]]}], "1.5 times"),
        ([{"points_mm": [point], "target_mm": [[2.0 * point[0], 0.0, 5.0]]} for point in CORNERS], "2 times"),
        ([{"where": "corners", "scale": 1.4, "slide": "z"}], "1.4 times"),
        ([{"where": "border", "scale": 1.0}], None),
        ([{"where": "corners", "scale": 2.0, "slide": "plane"}], None),
        ([{"points_mm": [[0.0, 0.0]], "target_mm": [[90.0, 0.0, 0.0]]}], None),
        ([], None),
    ],
)
def test_how_much_wider_it_is_held(pins: list[dict[str, Any]], times: str | None) -> None:
    design = Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 2}, "pins": pins})
    lines = list(held_wide(layout(design)))
    assert len(lines) == (times is not None)
    assert all(f"the pins hold the sheet {times} as wide as it was printed" in line for line in lines)


@pytest.mark.parametrize("name", gallery.names())
def test_no_design_of_the_gallery_is(name: str) -> None:
    assert not list(pin_warnings(layout(gallery.load(name)), False))


@pytest.mark.parametrize(
    ("pins", "about"),
    [
        ([{"points_mm": [[0.0, 0.0]]}], "a point"),
        ([{"points_mm": CORNERS}], "a line"),
        ([{"points_mm": CORNERS[:1]}, {"points_mm": CORNERS[1:], "step": 1}], "a line"),
        ([{"edges": [0]}], "a line"),
        ([{"points_mm": CORNERS, "slide": "plane"}], "a line"),
        ([{"edges": [0]}, {"edges": [3], "slide": "plane"}], None),
        ([{"points_mm": [*CORNERS, [0.0, 20.0]]}], None),
        ([{"where": "corners", "slide": "plane"}], None),
        ([{"where": "corners", "slide": "z"}], None),
        ([], None),
    ],
)
def test_sheets_that_may_swing_are_told_unless_they_hang(pins: list[dict[str, Any]], about: str | None) -> None:
    plan = layout(Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rings": 2}, "pins": pins}))
    lines = list(pin_warnings(plan, False))
    assert len(lines) == (about is not None) and all(f"turn about {about}:" in line for line in lines)
    assert not list(pin_warnings(plan, True))
