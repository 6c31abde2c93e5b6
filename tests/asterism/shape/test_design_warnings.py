"""Warnings of pins that stretch the sheet or leave it to swing, and of profiles that change nothing."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.shape.measures import held_wide, pin_warnings, sizing_warnings

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


def warnings(rings: int = 2, **stars: Any) -> list[str]:
    design = Design.from_dict({"stars": {"length_mm": 8.0} | stars, "border": {"rings": rings}})
    return list(sizing_warnings(design, layout(design)))


def radial(over_mm: float, to: float = 4.0) -> dict[str, Any]:
    return {"profile": "radial", "from": 8.0, "to": to, "over_mm": over_mm}


@pytest.mark.parametrize(
    ("profile", "end"),
    [
        (radial(60.0), None),
        (radial(5000.0, to=8.0), None),  # constant on purpose
        (radial(5000.0), "from, 8"),
        (radial(1e-3) | {"centre_mm": [0.01, 0.0]}, "to, 4"),
        ({"profile": "axis", "axis": "x", "from": 8.0, "to": 4.0, "over_mm": 9000.0}, "from, 8"),
        ({"profile": "linear", "from": 8.0, "to": 4.0, "start_mm": [0.0, 900.0], "end_mm": [0.0, 999.0]}, "from, 8"),
    ],
)
def test_a_profile_that_does_not_vary_is_named(profile: dict[str, Any], end: str | None) -> None:
    """But for a single star."""
    lines = warnings(length_mm=profile)
    assert len(lines) == (end is not None) and warnings(rings=0, length_mm=profile) == []
    for line in lines:
        assert line.startswith("stars.length_mm varies from 8 to 4") and f"the value of {end}: " in line
