"""Edges of the outline and of holes have numbers; the whole edge of a hole is held by the hole's number."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.meshing import mesh_layout

SQUARE = {"polygon_mm": [[5, 5], [12, 5], [12, 12], [5, 12]]}
ROUND = {"circle_mm": {"centre": [-9, -9], "radius": 4}}
LINES = [{"line_mm": [(-19, y), (19, y)]} for y in (-16, 0, 16)]


def sheet(*pins: dict[str, Any], holes: tuple[dict[str, Any], ...] = (SQUARE, ROUND)) -> Layout:
    border = {"rectangle_mm": (40.0, 40.0), "holes": holes}
    return layout(Design.from_dict({"rods": {"draw": LINES}, "border": border, "pins": pins}))


def test_the_sheet_lies_to_the_left_of_every_edge() -> None:
    plan = sheet()
    edges = plan.edges
    along = edges.end - edges.start
    left = np.column_stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    middle = 0.5 * (edges.start + edges.end)
    assert plan.is_on_sheet(middle + 0.01 * left).all() and not plan.is_on_sheet(middle - 0.01 * left).any()
    assert plan.area_mm2 == pytest.approx(1600.0 - 49.0 - np.pi * 16.0, rel=1e-3)


def test_corners_on_a_straight_side_do_not_end_it() -> None:
    notched = {"polygon_mm": [[8, 5], [12, 5], [12, 12], [5, 12], [5, 5]]}
    side = sheet(holes=(notched,)).edges.straight_sides
    assert len(set(side.tolist())) == 8 and len(set(side[4:].tolist())) == 4


def test_a_hole_is_held_all_around() -> None:
    plan = sheet({"holes": [1, 0], "scale": 0.8, "offset_mm": [0.0, 0.0, 3.0]})
    around, square = plan.edges.numbers(2), plan.edges.numbers(1)
    assert plan.supported_edges.tolist() == [*around, *square]
    assert [len(chain) for chain in plan.pins[0].chains(plan.edges)] == [len(around) + 1, 5]
    assert len(plan.pins[0].straight_stretches(plan.edges)) == len(around) + 4
    assert plan.distance_to_supports(np.array([[8.0, 4.0], [-9.0, -4.0]])) == pytest.approx([1.0, 1.0], abs=0.02)
    samples = plan.support_samples
    assert samples.places[:, :2] == pytest.approx(0.8 * samples.printed) and set(samples.places[:, 2]) == {3.0}
    mesh = mesh_layout(plan, 3.0)
    assert set(mesh.pin_vertices[0].tolist()) == {*mesh.hole_vertices[0].tolist(), *mesh.hole_vertices[1].tolist()}


def test_holes_have_the_order_of_the_design() -> None:
    ring = {"name": "window", "circle_mm": {"centre": [9, 9], "radius": 4}}
    border = {"rectangle_mm": (40.0, 40.0), "holes": [{"rods": "window"}, ROUND]}
    data = {"rods": {"draw": [*LINES, ring]}, "border": border, "pins": [{"holes": [0]}]}
    plan = layout(Design.from_dict(data))
    assert np.linalg.norm(plan.holes[0] - [9.0, 9.0], axis=1) == pytest.approx(4.0, abs=0.1)
    assert [len(rim) > 0 for rim in plan.hole_rims] == [True, False]
    mesh = mesh_layout(plan, 3.0)
    assert np.linalg.norm(mesh.points[mesh.pin_vertices[0]] - [9.0, 9.0], axis=1) == pytest.approx(4.0, abs=0.05)


@pytest.mark.parametrize(
    ("pins", "holes", "line"),
    [
        ([{"holes": [2]}], (SQUARE, ROUND), "pins[0].holes[0] = 2: must be from 0 to 1"),
        ([{"holes": [0, 0]}], (SQUARE, ROUND), "pins[0].holes[1] = 0: must not be listed twice"),
        ([{"holes": [0]}], (), "pins[0].holes = [0]: needs [[border.holes]]: the sheet has none"),
        ([{"holes": [0]}, {"holes": [0], "step": 1}], (SQUARE,), "must not hold what pins[0] holds already"),
        ([{"holes": [0]}, {"points_mm": [[5, 8]]}], (SQUARE,), "must not hold what pins[0] holds already"),
        ([{"holes": [0], "target_mm": [[0, 0, 1]]}], (SQUARE,), "does not go with holes, but scale and offset_mm do"),
        ([{"holes": [0], "edges": [1]}], (SQUARE,), "pins[0]"),
        ([{"points_mm": [[8, 8]]}], (SQUARE,), "must be on the sheet, not in a hole"),
    ],
)
def test_wrong_numbers_are_refused_in_one_line(pins: list[Any], holes: tuple[Any, ...], line: str) -> None:
    with pytest.raises(DesignError) as refused:
        sheet(*pins, holes=holes)
    assert line in str(refused.value) and "\n" not in str(refused.value)
