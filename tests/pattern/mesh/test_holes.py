"""Holes in sheets: by numbers, from drawings, with a printed rim; meshed, and refused in one line.

Edges of the outline and of holes have numbers; the whole edge of a hole is held by the number of the hole.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, MeshError
from asterism.pattern.geometry.planar import polygon_area, triangle_angles, triangle_areas
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout

SIDE = {"rectangle_mm": (60.0, 60.0)}
LINES = [{"name": f"line{y}", "line_mm": [(-40, y), (40, y)]} for y in (-20, 0, 20)]
ROUND = {"circle_mm": {"centre": (0.0, 10.0), "radius": 6.0}}


def design(*holes: dict[str, Any], **changes: Any) -> Design:
    return Design.from_dict({"rods": {"draw": LINES}, "border": SIDE | {"holes": list(holes)}} | changes)


def area(plan: Layout, edge: float = 3.0) -> float:
    """mm^2 of a mesh, all of whose triangles are good."""
    mesh = mesh_layout(plan, edge)
    assert triangle_angles(mesh.points, mesh.triangles).min() > 20.0
    return float(triangle_areas(mesh.points, mesh.triangles).sum())


@pytest.mark.parametrize(
    ("hole", "within"),
    [
        (ROUND, 0.03),  # chords
        ({"polygon_mm": [(-5, 5), (5, 5), (5, 15), (-5, 15)]}, 1e-9),
        ({"spline_mm": [(-6, 10), (0, 4), (6, 10), (0, 16)]}, 0.03),
    ],
)
def test_the_mesh_leaves_holes_out(hole: dict[str, Any], within: float) -> None:
    plan = layout(design(hole))
    missing = abs(polygon_area(plan.holes[0]))
    assert 95.0 < missing < 120.0 and 3600.0 - area(plan) == pytest.approx(missing, rel=within)


def test_lines_are_cut_at_holes_as_at_the_outline() -> None:
    plan = layout(design({"circle_mm": {"radius": 6.0}}))
    middle = [rod for rod in plan.graph.rods if rod.name == "line0"]
    ends = sorted(float(x) for rod in middle for x in rod.points[[0, -1], 0])
    assert ends == pytest.approx([-29.5, -6.5, 6.5, 29.5], abs=0.01)
    with pytest.raises(DesignError, match=r"line0 leaves the sheet at \[-?\d+\.\d+, 0\.00\]"):
        border = {"rectangle_mm": (100.0, 60.0), "holes": [{"circle_mm": {"radius": 6.0}}], "overhang": "refuse"}
        layout(Design.from_dict({"rods": {"draw": LINES}, "border": border}))


def test_a_printed_rim_is_the_edge_of_a_hole_and_meets_the_lines() -> None:
    window = {"name": "window", "circle_mm": {"centre": (0.0, 2.0), "radius": 8.0}}
    rods = {"draw": [*LINES, window]}
    plan = layout(design({"rods": "window"}, rods=rods))
    assert len(plan.holes) == 1 and len(plan.hole_rims[0]) == 3 and len(plan.graph.joints) == 2
    assert area(plan, 2.0) == pytest.approx(3600.0 - np.pi * 64.0, rel=1e-3)
    mesh = mesh_layout(plan, 2.0)
    on_rim = np.concatenate([mesh.rods[rod] for rod in plan.hole_rims[0]])
    assert set(mesh.hole_vertices[0]) == set(on_rim)


def test_holes_of_a_drawing(tmp_path: Path) -> None:
    (tmp_path / "holes.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm" viewBox="0 0 60 60">'
        '<g id="cut" stroke="red" fill="none"><circle cx="30" cy="20" r="6"/>'
        '<rect x="10" y="35" width="8" height="8"/></g>'
        '<g id="frame" stroke="black" fill="none"><rect width="60" height="60"/></g></svg>'
    )
    hole = {"file": "holes.svg", "layer": "cut"}
    data = {"rods": {"draw": LINES}, "border": SIDE | {"holes": [hole]}}
    first = Design.from_dict(data, tmp_path)
    plan = layout(first)
    assert sorted(len(ring) for ring in plan.holes)[0] == 4
    assert area(plan) == pytest.approx(3600.0 - np.pi * 36.0 - 64.0, rel=1e-3)
    assert Design.from_dict(first.to_dict()) == first  # without its file
    with pytest.raises(DesignError, match=r"layer = 'none': must have a closed line; layers with one: cut, frame"):
        Design.from_dict({**data, "border": SIDE | {"holes": [hole | {"layer": "none"}]}}, tmp_path)


@pytest.mark.parametrize(
    ("holes", "message"),
    [
        ([{"circle_mm": {"centre": (29, 0), "radius": 5}}], r"holes\[0\]: must be inside the outline, and .* \[30"),
        ([{"circle_mm": {"centre": (24.8, 10), "radius": 5}}], r"holes\[0\]: must leave 0.5 mm .* leaves 0.2\d* mm at"),
        ([ROUND, {"circle_mm": {"centre": (4, 10), "radius": 5}}], r"holes\[1\]: must be apart from border.holes\[0\]"),
        ([ROUND, {"circle_mm": {"centre": (0, 21.2), "radius": 5}}], r"holes\[1\]: must leave 0.5 mm"),
        ([{"polygon_mm": [(0, 0), (9, 9), (9, 0), (0, 9)]}], r"holes\[0\]: must not cross .* itself, as at \[4.5"),
        ([{"circle_mm": {"radius": 0.5}}], r"holes\[0\] = 0.78\d*: must enclose at least 1 mm2"),
        (
            [{"circle_mm": {"radius": [30, 1]}}],
            r"radius = .30.0, 1.0.: must be half axes .* at most 20 times the other",
        ),
        ([{"rods": "door"}], r"holes\[0\].rods = 'door': must be the name or layer of one line"),
        ([{"rods": "line0"}], r"holes\[0\].rods = 'line0': must be a closed line"),
        ([{}], r"holes\[0\]: must have one of circle_mm"),
    ],
)
def test_bad_holes_are_refused_with_their_place(holes: list[dict[str, Any]], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        layout(design(*holes))


@pytest.mark.parametrize("place", [(6.1, 10.0), (5.9, 10.0), (-4.243, 14.243), (0.0, 16.1)])
def test_pins_beside_the_edge_of_a_hole_are_moved_onto_it(place: tuple[float, float]) -> None:
    plan = layout(design(ROUND, pins=[{"points_mm": [place, (-30, -30), (30, -30)]}]))
    held = plan.pins[0].points[0]
    assert np.linalg.norm(held - place) <= 0.25
    assert np.linalg.norm(held - [0.0, 10.0]) == pytest.approx(6.0, abs=0.03)
    mesh = mesh_layout(plan, 3.0)
    assert np.linalg.norm(mesh.points - held, axis=1).min() < 1e-9
    assert triangle_angles(mesh.points, mesh.triangles).min() > 20.0


def test_stars_stand_clear_of_holes_and_their_arms_are_cut() -> None:
    stars = {"stars": {"length_mm": 8.0}, "border": {"rings": 2, "holes": [{"circle_mm": {"radius": 5.0}}]}}
    one = Design.from_dict(stars)
    plan = layout(one)
    assert len(plan.centres) == 18 and len(symmetries(one, plan)) == 6
    assert area(plan) < 0.99 * area(layout(Design.from_dict({**stars, "border": {"rings": 2}})))
    with pytest.raises(MeshError, match="holes"):
        mesh_layout(plan, 2.0, "aligned")
    wide = {"rings": 2, "star_margin_mm": 2.0, "holes": [{"circle_mm": {"radius": 12.0}}]}
    plan = layout(Design.from_dict({**stars, "border": wide}))
    assert len(plan.centres) == 18 and plan.arm_length.min() < 5.0
    assert np.linalg.norm(plan.arm_tip, axis=1).min() > 12.4


BOX = {"polygon_mm": [[5, 5], [12, 5], [12, 12], [5, 12]]}
DISC = {"circle_mm": {"centre": [-9, -9], "radius": 4}}
THREE_LINES = [{"line_mm": [(-19, y), (19, y)]} for y in (-16, 0, 16)]


def sheet(*pins: dict[str, Any], holes: tuple[dict[str, Any], ...] = (BOX, DISC)) -> Layout:
    border = {"rectangle_mm": (40.0, 40.0), "holes": holes}
    return layout(Design.from_dict({"rods": {"draw": THREE_LINES}, "border": border, "pins": pins}))


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
    border = {"rectangle_mm": (40.0, 40.0), "holes": [{"rods": "window"}, DISC]}
    data = {"rods": {"draw": [*THREE_LINES, ring]}, "border": border, "pins": [{"holes": [0]}]}
    plan = layout(Design.from_dict(data))
    assert np.linalg.norm(plan.holes[0] - [9.0, 9.0], axis=1) == pytest.approx(4.0, abs=0.1)
    assert [len(rim) > 0 for rim in plan.hole_rims] == [True, False]
    mesh = mesh_layout(plan, 3.0)
    assert np.linalg.norm(mesh.points[mesh.pin_vertices[0]] - [9.0, 9.0], axis=1) == pytest.approx(4.0, abs=0.05)


@pytest.mark.parametrize(
    ("pins", "holes", "line"),
    [
        ([{"holes": [2]}], (BOX, DISC), "pins[0].holes[0] = 2: must be from 0 to 1"),
        ([{"holes": [0, 0]}], (BOX, DISC), "pins[0].holes[1] = 0: must not be listed twice"),
        ([{"holes": [0]}], (), "pins[0].holes = [0]: needs [[border.holes]]: the sheet has none"),
        ([{"holes": [0]}, {"holes": [0], "step": 1}], (BOX,), "must not hold what pins[0] holds already"),
        ([{"holes": [0]}, {"points_mm": [[5, 8]]}], (BOX,), "must not hold what pins[0] holds already"),
        (
            [{"holes": [0], "target_mm": [[0, 0, 1]]}],
            (BOX,),
            "does not go with holes, but scale and offset_mm do",
        ),
        ([{"holes": [0], "edges": [1]}], (BOX,), "pins[0]"),
        ([{"points_mm": [[8, 8]]}], (BOX,), "must be on the sheet, not in a hole"),
    ],
)
def test_wrong_numbers_are_refused_in_one_line(pins: list[Any], holes: tuple[Any, ...], line: str) -> None:
    with pytest.raises(DesignError) as refused:
        sheet(*pins, holes=holes)
    assert line in str(refused.value) and "\n" not in str(refused.value)
