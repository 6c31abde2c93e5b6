"""Pins that move in space: linear response and equilibrium go on from the last one, and are those of a new preview."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.previews.session import Preview


def pinned(pins: list[dict[str, Any]], name: str = "dome") -> Design:
    return Design.from_dict(gallery.load(name).to_dict() | {"pins": pins})


POINTS = [[-48.0, -30.0], [48.0, -30.0], [48.0, 30.0], [-48.0, 30.0]]


def needles(*heights: float) -> Design:
    target = [[0.8 * x, 0.8 * y, z] for (x, y), z in zip(POINTS, heights, strict=True)]
    return pinned([{"points_mm": POINTS, "target_mm": target}])


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (gallery.load("dome"), pinned([{"where": "border", "scale": 0.76}])),
        (needles(0.0, 0.0, 0.0, 0.0), needles(0.0, 2.0, 0.0, 0.0)),
        (needles(0.0, 0.0, 0.0, 0.0), needles(-5.0, 12.0, 0.0, 3.0)),
    ],
    ids=["scale", "lift", "lift far"],
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
        nodes = preview.shell.node_positions
        errors.append(np.abs(nodes(linear.x) - nodes(final.x)).max())
    assert errors[0] < 0.2 and errors[1] < 0.02 * errors[0]


def test_the_linear_stage_stands_on_the_new_pins() -> None:
    preview = Preview(needles(0.0, 0.0, 0.0, 0.0))
    linear = next(preview.edit(needles(1.0, 2.0, 0.0, 3.0)))
    held = preview.at(np.array(POINTS), linear.x).smooth
    assert held[:, 2] == pytest.approx([1.0, 2.0, 0.0, 3.0], abs=1e-9)


def test_stars_and_pins_change_in_one_edit() -> None:
    data = needles(0.0, 2.0, 0.0, 0.0).to_dict()
    data["stars"] = data["stars"] | {"thickness_mm": 0.33}
    both = Design.from_dict(data)
    preview = Preview(needles(0.0, 0.0, 0.0, 0.0))
    preview.update(both)
    assert preview.equilibrium.energy == pytest.approx(Preview(both).equilibrium.energy, rel=1e-8)


def test_there_and_back_is_the_first_equilibrium() -> None:
    start = gallery.load("dome")
    preview = Preview(start)
    before = preview.equilibrium.x.copy()
    preview.update(pinned([{"where": "border", "scale": 0.78, "offset_mm": [3.0, 0.0, 1.0]}]))
    preview.update(start)
    assert preview.equilibrium.x == pytest.approx(before, abs=1e-6 * preview.shell.extent)


def test_pins_that_contradict_each_other_leave_the_preview() -> None:
    edges = [{"edges": [0, 1, 2], "scale": 0.74}, {"edges": [3, 4, 5], "scale": 0.74}]
    preview = Preview(pinned(edges))
    before = preview.state
    with pytest.raises(DesignError):
        preview.update(pinned([edges[0], edges[1] | {"scale": 0.8}]))
    assert preview.state is before


def test_pins_at_other_points_start_anew() -> None:
    preview = Preview(needles(0.0, 0.0, 0.0, 0.0))
    (stage,) = preview.edit(pinned([{"points_mm": POINTS[:3]}]))
    assert stage.name == "equilibrium"
