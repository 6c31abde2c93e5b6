"""The axis of a roll, from normals at the stars."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.roll_axis import roll_axis_from_normals


@pytest.mark.parametrize("second", [[0.0, 20.0], [8.0, 16.0], [0.0, 30.0]])
def test_rolls_are_seen_on_lattices_of_two_lengths(second: list[float]) -> None:
    lattice = {"kind": "custom", "vectors_mm": [[17.0, 0.0], second], "arms": 4}
    border = {"rectangle_mm": [110, 110]}
    plan = layout(Design.from_dict({"lattice": lattice, "stars": {"length_mm": 6.0}, "border": border}))
    turn = plan.centres[:, 1] / 25.0
    normal = np.column_stack([0.0 * turn, np.sin(turn), np.cos(turn)])
    axis = roll_axis_from_normals(plan, normal)
    assert axis is not None and min(axis, 180.0 - axis) < 1.0


@pytest.mark.parametrize(("waves", "is_roll"), [(0.0, True), (1.0, False), (2.0, False)])
def test_a_wave_is_no_roll(waves: float, is_roll: bool) -> None:
    """It bends about one axis, but both ways."""
    plan = layout(Design.from_dict({"stars": {"length_mm": 8.0}, "border": {"rectangle_mm": [220, 60]}}))
    x = plan.centres[:, 0]
    turn = 1.2 * np.sin(2.0 * np.pi * waves * x / 200.0) if waves else x / 60.0
    normal = np.column_stack([np.sin(turn), 0.0 * turn, np.cos(turn)])
    for nearly in (False, True):
        assert (roll_axis_from_normals(plan, normal, nearly) is not None) is is_roll
