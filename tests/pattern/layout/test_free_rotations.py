"""The turns that pins leave."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.free_motions import count_free_tilts, free_rotation_axes


def turns(*pins: dict[str, Any]) -> tuple[np.ndarray, int]:
    border = {"rectangle_mm": [100, 60]}
    plan = layout(Design.from_dict({"stars": {"length_mm": 8}, "border": border, "pins": list(pins)}))
    return free_rotation_axes(plan), count_free_tilts(plan)


@pytest.mark.parametrize("target", [[30.0, 5.0, 0.0], [30.0, 5.0, 20.0], [8.0, -20.0, 35.0]])
def test_two_points_leave_the_turn_about_the_line_through_their_places(target: list[float]) -> None:
    places = [[0.0, 0.0, 0.0], target]
    axes, tilted = turns({"points_mm": [[0.0, 0.0], [40.0, 0.0]], "target_mm": places})
    assert np.abs(axes @ target) == pytest.approx([np.linalg.norm(target)]) and tilted == 1


def test_a_point_leaves_all_turns_and_so_does_nothing() -> None:
    for pins in ([], [{"points_mm": [[3.0, 4.0]]}]):
        axes, tilted = turns(*pins)
        assert axes @ axes.T == pytest.approx(np.eye(3)) and tilted == 2


def test_what_slides_on_the_ground_turns_upright_and_a_held_border_does_not() -> None:
    axes, tilted = turns({"where": "corners", "slide": "plane"})
    assert np.abs(axes) == pytest.approx(np.array([[0.0, 0.0, 1.0]])) and tilted == 0
    axes, tilted = turns({"where": "border"})
    assert len(axes) == tilted == 0
