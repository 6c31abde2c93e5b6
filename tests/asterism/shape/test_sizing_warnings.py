"""Profiles that leave all stars equal are named: their distances are mostly in another unit."""

from __future__ import annotations

from typing import Any

import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.shape.sizing_warnings import sizing_warnings


def warnings(rings: int = 2, **stars: Any) -> list[str]:
    design = Design.from_dict({"stars": {"length_mm": 8.0} | stars, "border": {"rings": rings}})
    return list(sizing_warnings(design, layout(design)))


def radial(over_mm: float, to: float = 4.0) -> dict[str, Any]:
    return {"profile": "radial", "from": 8.0, "to": to, "over_mm": over_mm}


@pytest.mark.parametrize(
    ("profile", "end"),
    [
        (radial(5000.0), "from, 8"),
        (radial(1e-3) | {"centre_mm": [0.01, 0.0]}, "to, 4"),
        ({"profile": "axis", "axis": "x", "from": 8.0, "to": 4.0, "over_mm": 9000.0}, "from, 8"),
        ({"profile": "linear", "from": 8.0, "to": 4.0, "start_mm": [0.0, 900.0], "end_mm": [0.0, 999.0]}, "from, 8"),
    ],
)
def test_a_profile_that_does_not_vary_is_named(profile: dict[str, Any], end: str) -> None:
    (line,) = warnings(length_mm=profile)
    assert line.startswith("stars.length_mm varies from 8 to 4") and f"the value of {end}: " in line


def test_profiles_that_vary_or_are_constant_on_purpose_are_not_named() -> None:
    assert warnings(length_mm=radial(60.0)) == []
    assert warnings(length_mm=radial(5000.0, to=8.0)) == []
    assert warnings(rings=0, length_mm=radial(5000.0)) == []
