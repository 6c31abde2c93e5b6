"""Pins further apart than fabric stretches are refused before anything is computed."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout

U_SHAPE = [[0, 0], [150, 0], [150, 100], [110, 100], [110, 40], [40, 40], [40, 100], [0, 100]]


def sheet(pins: list[dict[str, Any]], border: dict[str, Any] | None = None) -> None:
    layout(Design.from_dict({"stars": {"length_mm": 8.0}, "border": border or {"rings": 2}, "pins": pins}))


@pytest.mark.parametrize(
    "pins",
    [
        [{"where": "corners", "scale": 4.0}],
        [{"where": "border", "scale": 4.0}],
        [{"corners": [0]}, {"corners": [3], "offset_mm": [0.0, 0.0, 2000.0]}],
        [{"points_mm": [[-20.0, 0.0], [20.0, 0.0]], "target_mm": [[-2000.0, 0.0, 0.0], [20.0, 0.0, 0.0]]}],
        [{"points_mm": [[x, 0.5 * x] for x in range(-30, 31)], "scale": 9.0}],
    ],
)
def test_pins_that_are_too_far_apart_are_named(pins: list[dict[str, Any]]) -> None:
    with pytest.raises(DesignError, match=r"pins\[\d\]: pulls the sheet to .* at most 3 times") as caught:
        sheet(pins)
    assert caught.value.place_mm is not None


@pytest.mark.parametrize(
    "pins",
    [
        [{"where": "corners", "scale": 2.9}],
        [{"corners": [0, 1]}, {"corners": [3], "offset_mm": [0.0, 0.0, 2000.0], "slide": "z"}],
        [{"points_mm": [[0.0, 0.0], [1.0, 0.0]], "target_mm": [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]}],
    ],
)
def test_pins_within_reach_are_allowed(pins: list[dict[str, Any]]) -> None:
    sheet(pins)


def test_both_ends_of_a_bent_strip_may_be_far_apart() -> None:
    """Their distance on the print is short, but the sheet between them is long."""
    ends = {"points_mm": [[40.0, 100.0], [110.0, 100.0]]}
    sheet([{**ends, "target_mm": [[-80.0, 100.0, 0.0], [230.0, 100.0, 0.0]]}], {"polygon_mm": U_SHAPE})
    with pytest.raises(DesignError, match="times its printed length"):
        sheet([{**ends, "target_mm": [[-800.0, 100.0, 0.0], [900.0, 100.0, 0.0]]}], {"polygon_mm": U_SHAPE})
