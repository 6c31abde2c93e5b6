"""Holes in sheets: by numbers, from drawings, with a printed rim; meshed, and refused in one line."""

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
