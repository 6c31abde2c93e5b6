"""Symmetries of layouts: how many there are, and what breaks them; the axis of a roll, from normals at the stars."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.pattern.layout.symmetries import symmetries

HEAVY = {"modulus_mpa": 1.0}
HEXAGON = {"stars": {"length_mm": 8.0}, "border": {"rings": 1}}


def count(**changes: object) -> tuple[int, int]:
    """All symmetries, and mirrors among them."""
    return count_of(HEXAGON | changes)


def count_of(data: dict[str, Any]) -> tuple[int, int]:
    design = Design.from_dict(data)
    found = symmetries(design, layout(design))
    np.testing.assert_allclose(found[0].turn, np.eye(2), atol=1e-12)
    return len(found), sum(one.mirrors for one in found)


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, (6, 3)),
        ({"lattice": {"arms": 6, "orientation_deg": 0.0}}, (12, 6)),
        ({"lattice": {"orientation_deg": 10.0}}, (3, 0)),
        ({"stars": {"length_mm": 8.0, "override": [{"at_mm": [0.0, 17.3205], "length_mm": 7.0}]}}, (2, 1)),
        ({"stars": {"length_mm": 8.0, "thickness_mm": {"formula": "0.3 + 0.001*x + 0.0003*y"}}}, (1, 0)),
        ({"fabric": {"stretch": [1.35, 1.3]}}, (2, 1)),
        ({"fabric": {"modulus_mpa": [9.0, 4.0], "grain_deg": 90.0}}, (2, 1)),
        ({"fabric": {"modulus_mpa": [9.0, 4.0], "grain_deg": 10.0}}, (1, 0)),
        ({"pins": [{"where": "border", "scale": 0.8}]}, (6, 3)),
        ({"pins": [{"where": "border", "scale": 0.8, "offset_mm": [5.0, 0.0, 2.0]}]}, (6, 3)),
        ({"pins": [{"edges": [0]}]}, (1, 0)),
        ({"pins": [{"edges": [0, 3]}]}, (2, 1)),
        ({"pins": [{"edges": [0, 1]}]}, (2, 1)),
        ({"pins": [{"edges": [0, 2, 4]}]}, (3, 0)),
        ({"pins": [{"corners": [1], "scale": 0.9}]}, (2, 1)),
        ({"pins": [{"corners": [0, 2, 4], "scale": 0.9}, {"corners": [1, 3, 5], "scale": 0.8}]}, (6, 3)),
        ({"pins": [{"corners": [0, 2], "scale": 0.9}, {"corners": [4], "scale": 0.9, "step": 1}]}, (2, 1)),
        ({"pins": [{"corners": [0, 2, 4], "target_mm": [[40, 0, 0], [0, 40, 0], [0, 0, 40]]}]}, (1, 0)),
        ({"border": {"rectangle_mm": [100.0, 60.0]}}, (2, 1)),
        ({"border": {"rectangle_mm": [100.0, 60.0]}, "lattice": {"kind": "square", "arms": 4}}, (4, 2)),
        ({"border": {"rectangle_mm": [60.0, 60.0]}, "lattice": {"kind": "square", "arms": 4}}, (8, 4)),
        # tips that meet
        ({"stars": {"length_fraction": 0.5}, "lattice": {"arms": 6, "orientation_deg": 0.0}}, (12, 6)),
        # weight must keep its direction
        ({"fabric": HEAVY, "gravity": {"on": True}}, (6, 3)),
        ({"fabric": HEAVY, "gravity": {"on": True, "direction": [0.0, 1.0, 0.0]}}, (2, 1)),
        ({"fabric": HEAVY, "gravity": {"on": True, "direction": [1.0, 0.0, 0.0]}}, (1, 0)),
    ],
)
def test_count(changes: dict, expected: tuple[int, int]) -> None:
    assert count(**changes) == expected


@pytest.mark.parametrize("name", gallery.names())
def test_they_are_a_group_that_maps_stars_to_equal_ones(name: str) -> None:
    design = gallery.load(name)
    plan = layout(design)
    found = symmetries(design, plan)
    np.testing.assert_allclose(found[0].turn, np.eye(2), atol=1e-12)
    turns = np.array([one.turn for one in found])
    for one in found:
        np.testing.assert_allclose(plan.centres @ one.turn.T + one.shift, plan.centres[one.star], atol=1e-6)
        product = turns @ one.turn
        gap = np.abs(product[:, None] - turns[None]).max(axis=(2, 3))
        assert (gap.min(axis=1) < 1e-9).all()


def test_outlines_of_the_same_corners_joined_otherwise_are_not_the_same() -> None:
    """The upper side zigzags: mirrored, the corners fall on each other and the sides do not."""
    zigzag = [[-60, -60], [60, -60], [60, 40], [10, 15], [10, 35], [-10, 15], [-10, 35], [-60, 40]]
    even = [[-60, -60], [60, -60], [60, 40], [10, 35], [10, 15], [-10, 15], [-10, 35], [-60, 40]]
    for corners, mirrors in ((zigzag, 0), (even, 1)):
        assert count(border={"polygon_mm": corners, "star_margin_mm": 20.0})[1] == mirrors


@pytest.mark.parametrize("pins", [{"where": "border", "scale": 0.7}, {"edges": [0, 1]}, {"edges": [0], "step": 1}])
def test_a_corner_on_a_held_side_changes_nothing(pins: dict[str, object]) -> None:
    square = [[-45, -45], [45, -45], [45, 45], [-45, 45]]
    lattice = {"kind": "square", "arms": 4, "spacing_mm": 15}
    whole = {"stars": {"length_mm": 5.0}, "lattice": lattice, "border": {"polygon_mm": square}}
    more = whole | {"border": {"polygon_mm": [square[0], [10, -45], *square[1:]]}, "pins": [pins]}
    one = count(**whole, pins=[pins | {"edges": [0]} if "edges" in pins else pins])
    assert "edges" in pins or one == (8, 4)
    # both halves of the side, or the first alone, which is not a side of the square
    assert (count(**more) == one) is (pins.get("edges") != [0])


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


@pytest.mark.slow
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
def test_count_of_drawings(data: dict[str, Any], expected: tuple[int, int]) -> None:
    assert count_of(data) == expected


def test_each_symmetry_maps_every_rod_onto_a_rod() -> None:
    design = Design.from_dict(flower(17.0))
    plan = layout(design)
    line = plan.graph.rods[0].points
    for motion in symmetries(design, plan):
        moved = line @ motion.turn.T + motion.shift
        assert np.linalg.norm(moved[:, None] - line, axis=2).min(axis=1).max() < 1.0


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
