"""Symmetries of drawings: how many there are, and what breaks them; lattice points on drawn sheets."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries

RING = {"rods": {"draw": [{"name": "rim", "circle_mm": {"radius": 20.0}}]}, "border": {"rods": "rim"}}
LINES = [{"line_mm": [(-20, y), (20, y)]} for y in (-10, 0, 10)]
NET = {
    "lattice": {"kind": "square", "spacing_mm": 10.0},
    "rods": {"motif": [{"line_mm": [(0, 0), (10, 0)]}, {"line_mm": [(0, 0), (0, 10)]}]},
    "border": {"rectangle_mm": (42.0, 42.0)},
}


def sheet(lines: list[dict[str, Any]], **changes: Any) -> dict[str, Any]:
    return {"rods": {"draw": lines}, "border": {"rectangle_mm": (50.0, 40.0)}} | changes


def flower(turn_deg: float, lobes: int = 5) -> dict[str, Any]:
    """A closed wavy line, turned."""
    a = np.linspace(0.0, 2 * np.pi, 20 * lobes, endpoint=False)
    r, a = 20.0 + 3.0 * np.cos(lobes * a), a + np.radians(turn_deg)
    points = np.column_stack([r * np.cos(a), r * np.sin(a)]).tolist()
    rim = {"name": "rim", "spline_mm": points, "closed": True}
    return {"rods": {"draw": [rim]}, "border": {"rods": "rim"}}


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (RING, (24, 12)),  # of the rotations of a circle, those up to the order that is looked for
        (sheet(LINES), (4, 2)),
        (sheet(LINES[:2]), (2, 1)),
        (sheet([*LINES, {"arc_mm": {"radius": 3.0, "from_deg": 0, "to_deg": 90, "centre": (0, 3)}}]), (1, 0)),
        (sheet([{**LINES[0], "thickness_mm": 0.5}, *LINES[1:]]), (2, 1)),
        (sheet([{**LINES[0], "kappa_bar_per_mm": 0.01}, *LINES[1:]]), (2, 1)),
        (sheet(LINES, pins=[{"corners": [0]}]), (1, 0)),
        (sheet(LINES, pins=[{"edges": [0, 2]}]), (4, 2)),
        (sheet(LINES, fabric={"stretch": [1.35, 1.2]}), (4, 2)),
        (NET, (8, 4)),
        (NET | {"fabric": {"stretch": [1.35, 1.2]}}, (4, 2)),
        (flower(0.0), (10, 5)),
        (flower(17.0), (10, 5)),
        (flower(17.0) | {"fabric": {"stretch": [1.35, 1.2]}}, (1, 0)),
    ],
)
def test_count(data: dict[str, Any], expected: tuple[int, int]) -> None:
    design = Design.from_dict(data)
    found = symmetries(design, layout(design))
    assert (len(found), sum(one.mirrors for one in found)) == expected
    np.testing.assert_allclose(found[0].turn, np.eye(2), atol=1e-12)


def test_each_symmetry_maps_every_rod_onto_a_rod() -> None:
    design = Design.from_dict(flower(17.0))
    plan = layout(design)
    line = plan.graph.rods[0].points
    for motion in symmetries(design, plan):
        moved = line @ motion.turn.T + motion.shift
        assert np.linalg.norm(moved[:, None] - line, axis=2).min(axis=1).max() < 1.0


def test_sample_points_are_neighbours_on_the_sheet() -> None:
    plan = layout(Design.from_dict(NET))
    assert len(plan.sample_points) == 25 and len(plan.sample_pairs) == 40
    steps = plan.sample_points[plan.sample_pairs[:, 1]] - plan.sample_points[plan.sample_pairs[:, 0]]
    np.testing.assert_allclose(np.linalg.norm(steps, axis=1), 10.0)
