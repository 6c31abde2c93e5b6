"""Pins that are further apart than in the print are told, however they are said."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.held_wide import held_wide
from pattern import gallery
from pattern.build import layout
from pattern.design import Design

CORNERS = [[-30.0, 0.0], [30.0, 0.0]]


@pytest.mark.parametrize(
    ("pins", "times"),
    [
        ([{"where": "border", "scale": 2.0}], "2 times"),
        ([{"where": "corners", "scale": 1.2}], "1.2 times"),
        ([{"points_mm": CORNERS, "target_mm": [[-45.0, 0.0, 0.0], [45.0, 0.0, 0.0]]}], "1.5 times"),
        ([{"points_mm": [point], "target_mm": [[2.0 * point[0], 0.0, 5.0]]} for point in CORNERS], "2 times"),
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
    assert not list(held_wide(layout(gallery.load(name))))
