"""Pins that move in space: linear response and equilibrium go on from the last one, and are those of a new preview."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from tests.asterism.previews.designs import edited


def pinned(pins: list[dict[str, Any]]) -> Design:
    return edited("dome", pins=pins)


POINTS = [[-48.0, -30.0], [48.0, -30.0], [48.0, 30.0], [-48.0, 30.0]]


def needles(*heights: float, **stars: Any) -> Design:
    target = [[0.8 * x, 0.8 * y, z] for (x, y), z in zip(POINTS, heights, strict=True)]
    return edited("dome", pins=[{"points_mm": POINTS, "target_mm": target}], stars=stars)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (gallery.load("dome"), pinned([{"where": "border", "scale": 0.76}])),
        (needles(0.0, 0.0, 0.0, 0.0), needles(-5.0, 12.0, 0.0, 3.0, thickness_mm=0.33)),
    ],
    ids=["scale", "far, and other stars"],
)
def test_moved_pins_lead_to_the_equilibrium_of_a_new_preview(first: Design, second: Design) -> None:
    preview = Preview(first)
    stages = list(preview.edit(second))
    assert [stage.name for stage in stages] == ["linear", "equilibrium"]
    fresh = Preview(second)
    assert preview.equilibrium.is_minimum and preview.equilibrium.guess == "edit"
    assert preview.equilibrium.energy == pytest.approx(fresh.equilibrium.energy, rel=1e-8)
    assert stages[1].x == pytest.approx(fresh.equilibrium.x, abs=1e-5 * preview.shell.extent)


def test_the_linear_response_is_right_to_first_order() -> None:
    """A tenth of the move leaves a hundredth of the error."""
    start = needles(0.0, 0.0, 0.0, 0.0)
    errors = []
    for move in (2.0, 0.2):
        preview = Preview(start)
        linear, final = preview.edit(needles(0.0, move, 0.0, 0.0))
        held = preview.at(np.array(POINTS), linear.x).smooth
        assert held[:, 2] == pytest.approx([0.0, move, 0.0, 0.0], abs=1e-9)
        nodes = preview.shell.node_positions
        errors.append(np.abs(nodes(linear.x) - nodes(final.x)).max())
    assert errors[0] < 0.2 and errors[1] < 0.02 * errors[0]


def test_pins_at_other_points_start_anew() -> None:
    preview = Preview(needles(0.0, 0.0, 0.0, 0.0))
    (stage,) = preview.edit(pinned([{"points_mm": POINTS[:3]}]))
    assert stage.name == "equilibrium"
