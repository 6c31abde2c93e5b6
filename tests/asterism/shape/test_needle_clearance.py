"""How far a sheet rises over its needles and hangs below them, on surfaces of known heights."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.shape.needle_clearance import needle_clearance
from tests.asterism import sheets


def saddle(flat: Floats) -> Floats:
    """20 mm up at the ends along x, 8 mm down at the ends along y."""
    x, y = flat.T
    return np.column_stack([flat, 20.0 * (x / 50.0) ** 2 - 8.0 * (y / 40.0) ** 2])


@pytest.mark.parametrize(
    ("points", "above", "below"),
    [
        ([[0.0, 0.0]], 20.0, 8.0),
        ([[0.0, 0.0], [50.0, 0.0]], 0.0, 8.0),
        ([[0.0, -40.0], [0.0, 40.0]], 28.0, 0.0),
        ([], None, None),
    ],
)
def test_heights_count_from_the_highest_and_from_the_lowest_needle(
    points: list[list[float]], above: float | None, below: float | None
) -> None:
    pins: list[dict[str, Any]] = [{"points_mm": points}] if points else []
    plan = layout(
        Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rectangle_mm": [100.0, 80.0]}, "pins": pins})
    )
    clearance = needle_clearance(plan, sheets.sheet(saddle, edge=4.0))
    if above is None or below is None:
        assert clearance is None
    else:
        assert clearance == pytest.approx((above, below), abs=0.2)
