"""Graphs and meshes of drawings and stars: lines, curves, motifs, rims, cuts, tips that meet, and what is refused.

Stars and drawn rods in one design: laid out side by side, meshed, and refused where they would touch. The graph of one
cell has each rod once, whatever the place of the motif, and bonded to the images of its neighbours.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, MeshError
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.design.rods import Rods
from asterism.pattern.geometry.planar import polygon_area, triangle_angles, triangle_areas, turning_angles
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.pattern.rods.drawn_graph import Piece, cut_lines
from asterism.pattern.rods.motif_graph import MotifGraph, motif_graph
from benchmarks.fuzz.mutations import mutated_table

SQUARE = {"rectangle_mm": [60.0, 60.0]}


def sheet(*draw: dict[str, Any], border: dict[str, Any] = SQUARE, **more: Any) -> Layout:
    rods = {"draw": list(draw), **more.pop("rods", {})}
    return layout(Design.from_dict({"rods": rods, "border": border, **more}))


def test_arc_and_spline_pass_where_they_are_told() -> None:
    plan = sheet(
        {"arc_mm": {"radius": 10, "from_deg": 90, "to_deg": 0}}, {"spline_mm": [[-20, -20], [0, -15], [20, -20]]}
    )
    arc, spline = plan.graph.rods
    assert arc.points[0] == pytest.approx([0, 10]) and arc.points[-1] == pytest.approx([10, 0], abs=1e-9)
    assert arc.length == pytest.approx(5 * np.pi, rel=1e-3)
    assert np.linalg.norm(spline.points - [0, -15], axis=1).min() < 0.5
    assert np.abs(turning_angles(spline.points)[1:-1]).max() < np.radians(5.0)  # smooth


def test_sizes_vary_along_a_rod() -> None:
    profile = {"profile": "linear", "from": 0.3, "to": 0.9, "start_mm": [-20, 0], "end_mm": [20, 0]}
    plan = sheet({"line_mm": [[-20, 0], [20, 0]], "thickness_mm": profile, "kappa_bar_per_mm": 0.01})
    (rod,) = plan.graph.rods
    assert rod.at(rod.thickness, np.array([0.0, 0.25, 1.0])) == pytest.approx([0.3, 0.45, 0.9])
    assert rod.kappa_bar == 0.01


def test_motif_repeats_on_the_lattice_and_bonds_to_its_copies() -> None:
    lattice = {"kind": "square", "spacing_mm": 10.0}
    motif = [{"line_mm": [[0, 0], [10, 0]]}, {"line_mm": [[0, 0], [0, 10]]}]
    plan = sheet(lattice=lattice, rods={"motif": motif})
    degree = np.array([len(ends) for ends in plan.graph.ends_at])
    assert (degree == 4).sum() == 25 and set(degree) == {1, 4}
    assert plan.spacing_mm == 10.0 and max(rod.group for rod in plan.graph.rods) > 20
    # its sample points are neighbours on the sheet
    steps = np.diff(plan.sample_points[plan.sample_pairs], axis=1)[:, 0]
    np.testing.assert_allclose(np.linalg.norm(steps, axis=1), 10.0)
    assert (len(plan.sample_points), len(steps)) == (25, 40)


def test_rim_is_the_outline_and_ribs_end_on_it() -> None:
    plan = sheet(
        {"name": "rim", "circle_mm": {"radius": 25}}, {"name": "rib", "line_mm": [[-30, 0], [30, 0]]},
        border={"rods": "rim"},
    )  # fmt: skip
    assert len(plan.rim) == 2 and [len(plan.graph.ends_at[node]) for node in plan.graph.joints] == [3, 3]
    assert polygon_area(plan.outline) == pytest.approx(625 * np.pi, rel=2e-3)
    mesh = mesh_layout(plan, 3.0)
    border = set(mesh.border_vertices.tolist())
    assert all(set(mesh.rods[rod].tolist()) <= border for rod in plan.rim)
    assert triangle_angles(mesh.points, mesh.triangles).min() >= 20.0
    assert triangle_areas(mesh.points, mesh.triangles).sum() == pytest.approx(625 * np.pi, rel=0.02)


def test_lines_that_leave_the_sheet_may_be_refused() -> None:
    long = {"name": "rib", "line_mm": [[-40, 5], [40, 5]]}
    said = r"rib leaves the sheet at \[-?40.00, 5.00\]; overhang = \"cut\" cuts it there"
    with pytest.raises(DesignError, match=said):
        sheet(long, border={**SQUARE, "overhang": "refuse"})


def test_pins_on_rods_are_vertices_of_the_mesh() -> None:
    pins = [{"points_mm": [[10.2, 0.1], [0, 20.1]]}]
    plan = sheet({"line_mm": [[-20, 0], [20, 0]]}, {"circle_mm": {"radius": 20}}, pins=pins)
    assert plan.pins[0].points[0] == pytest.approx([10.2, 0.0])
    mesh = mesh_layout(plan, 4.0)
    places = mesh.points[mesh.pin_vertices[0]]
    assert places == pytest.approx(plan.pins[0].points)
    assert mesh.pin_vertices[0][0] in np.concatenate(mesh.rods)


RIB = {"name": "rib", "line_mm": [[-9, 0], [9, 0]]}
REFUSED = [
    ([{"line_mm": [[-20, 0], [20, 0]]}, {"line_mm": [[-20, 0.8], [20, 0.8]]}], "are 0.80 mm apart"),
    ([{"line_mm": [[-20, 0], [20, 0]]}, {"line_mm": [[-20, 0], [20, 6]]}], "meet at 9 deg"),
    ([{"line_mm": [[0, 0], [0.8, 0]]}], "has a piece of 0.80 mm"),
    ([{"line_mm": [[0, 0], [9, 0]], "thickness_mm": 7}], "thickness_mm = 7.0: must be from 0.05 to 5 along draw"),
    ([{"line_mm": [[0, 0], [0.08, 0], [0.08, 0.06]], "closed": True}], "shorter than 0.6 mm: is the drawing in mm?"),
    ([RIB, {"line_mm": [[0, 3], [9, 3]], "width_mm": -1.0}], "rods.draw[1].width_mm = -1.0: must be from 0.1 to 10"),
    ([RIB, RIB], "two lines named rib lie on each other"),
    ([{"line_mm": [[0, 0], [9, 0], [9, 0]]}], "has a point twice"),
    ([{"line_mm": [[100, 0], [109, 0]]}], "must have at least one line on the sheet"),
    ([{"line_mm": [[0, 0], [9, 0]], "circle_mm": {"radius": 3}}], "must have one of line_mm, spline_mm"),
    ([{"arc_mm": {"radius": 3, "from_deg": 0, "to_deg": 360}}], "circle_mm is a whole circle"),
    ([{"circle_mm": {"radius": 3}, "closed": True}], "a circle is closed"),
    ([], "must have a line"),
]


@pytest.mark.parametrize(("draw", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_is_refused(draw: list[dict[str, Any]], words: str) -> None:
    with pytest.raises(DesignError) as caught:
        sheet(*draw)
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("border", "words"),
    [({"rods": "edge"}, "must be the name or layer of one line, of rib"), ({"rods": "rib"}, "must be a closed line")],
)
def test_rims_that_are_none(border: dict[str, Any], words: str) -> None:
    with pytest.raises(DesignError, match=words):
        sheet({"name": "rib", "line_mm": [[-20, 0], [20, 0]]}, border=border)


def test_rims_and_meshes_of_several_lines() -> None:
    rims = [{"name": "rim", "circle_mm": {"radius": radius}} for radius in (10, 20)]
    with pytest.raises(DesignError, match="must be the name or layer of one line; 2 lines have it"):
        sheet(*rims, border={"rods": "rim"})
    close = [{"line_mm": [[-20, -y], [20, y]]} for y in (0.0, 7.4)]  # they cross at 20.3 degrees
    with pytest.raises(MeshError, match="lines are too close together"):
        mesh_layout(sheet(*close), 2.0)


def test_a_pattern_is_needed_and_drawn_rods_have_no_aligned_mesh() -> None:
    rods = {"draw": [{"line_mm": [[-20, 0], [20, 0]]}]}
    with pytest.raises(DesignError, match=r"must have \[stars\] or \[rods\]"):
        Design.from_dict({"border": SQUARE})
    design = Design.from_dict({"rods": rods, "border": SQUARE})
    assert Design.from_dict(design.to_dict()) == design
    with pytest.raises(MeshError, match="drawn rods have no aligned mesh"):
        mesh_layout(layout(design), 4.0, "aligned")


def test_stars_apart_have_no_joint() -> None:
    sheet = layout(Design.from_dict({"stars": {"length_mm": 10.0}, "border": {"rings": 1}}))
    assert sheet.graph.joints == () and sheet.graph.links == ()
    assert sheet.graph.paired.tolist() == list(range(7))
    assert [rod.group for rod in sheet.graph.rods] == sheet.arm_star.tolist()
    np.testing.assert_array_equal([rod.points[1] for rod in sheet.graph.rods], sheet.arm_tip)


def test_three_tips_meet_in_one_joint() -> None:
    """Turned by 30 degrees, with arms of d/sqrt(3), the stars are a honeycomb."""
    stars, lattice = {"length_mm": 10.0}, {"orientation_deg": 30}
    graph = layout(Design.from_dict({"stars": stars, "lattice": lattice, "border": {"rings": 1}})).graph
    assert sorted(len(graph.ends_at[node]) for node in graph.joints) == [2] * 3 + [3] * 3
    assert len(graph.paired) == 7


def test_tips_on_the_centre_of_a_neighbour_are_bonded_to_its_arms() -> None:
    graph = layout(Design.from_dict({"stars": {"length_fraction": 1.0}, "border": {"rings": 1}})).graph
    # three arms of its own and three that reach the central star
    assert len(graph.ends_at[0]) == 6 and 0 in graph.joints and 0 not in graph.paired


def cut(*lines: Any) -> tuple[Floats, list[Piece]]:
    places = [np.array(line, dtype=float) for line in lines]
    return cut_lines(places, 0.1, 0.5, [f"line{k}" for k in range(len(lines))])


def arc(turn: float) -> Floats:
    angle = np.linspace(0.0, turn, 121)
    return 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])


BASE, LOOP = [(-5, 0), (5, 0)], [(0, 0), (10, 0), (10, 5), (5, 5), (5, -5)]
RING = np.concatenate([arc(2.0 * np.pi)[:-1], [(10.0, 0.0)]])


@pytest.mark.parametrize(
    ("lines", "ends"),
    [
        ([BASE, [(1, -5), (1, 5)]], [1, 1, 1, 1, 4]),
        ([BASE, [(1, 0.08), (1, 5)]], [1, 1, 1, 3]),  # an end beside a line is joined to it
        ([BASE, [(1, 0.2), (1, 5)]], [1, 1, 1, 1]),  # and one further away is not
        ([BASE, [(1, -0.3), (1, 5)]], [1, 1, 1, 3]),  # one that overshoots leaves no stub
        ([BASE, [(0, -5), (0, 5)], [(-5, -4.8), (5, 5.2)]], [1] * 6 + [6]),  # nearly in one point
        ([[(0, 0), (5, 0), (5, 5)]], [1, 1, 2]),  # a corner is a node
        ([arc(np.pi)], [1, 1]),  # and a curve has none
        ([RING], [2]),  # one seam
        ([RING, [(-20, 3), (20, 3)]], [1, 1, 2, 4, 4]),  # which stays a node
        ([LOOP], [1, 1, 2, 2, 2, 4]),  # a line that crosses itself
    ],
)
def test_lines_are_cut_where_they_meet(lines: list[Any], ends: list[int]) -> None:
    nodes, pieces = cut(*lines)
    found = np.bincount([end for piece in pieces for end in (piece.start, piece.end)], minlength=len(nodes))
    assert sorted(found.tolist()) == ends


def test_pieces_end_at_the_crossing_and_nothing_is_lost() -> None:
    nodes, pieces = cut(LOOP)
    assert np.abs(nodes - [5.0, 0.0]).sum(axis=1).min() < 1e-12
    assert sum(np.linalg.norm(np.diff(p.points, axis=0), axis=1).sum() for p in pieces) == pytest.approx(30.0)
    with pytest.raises(DesignError, match=r"line0 and line1 lie on each other at \[.*\]: draw the line once"):
        cut([(0, 0), (10, 0)], [(2, 0), (7, 0)])


@pytest.mark.slow
def test_a_scribble_is_refused_before_all_its_crossings_are_computed() -> None:
    """200 million of them would take more than the memory."""
    scribble = np.random.default_rng(0).uniform(-45.0, 45.0, (20_000, 2))
    start = time.process_time()
    with pytest.raises(DesignError, match="lines must meet at most 100000 times"):
        cut_lines([scribble], 0.1, 0.6, ["scribble"])
    assert time.process_time() - start < 20.0


RIM = {"name": "rim", "circle_mm": {"radius": 40.0}, "thickness_mm": 0.6}
STARS = {"length_mm": 7.0, "thickness_mm": 0.4}


def design(**changes: Any) -> Design:
    return Design.from_dict({"stars": STARS, "rods": {"draw": [RIM]}, "border": {"rods": "rim"}} | changes)


def test_stars_stand_within_a_printed_rim() -> None:
    plan = layout(design())
    assert len(plan.centres) == 13 and len(plan.drawn_rods) == 1 and plan.rim == (len(plan.arm_star),)
    assert [rod.group for rod in plan.graph.rods[:3]] == [0, 0, 0] and plan.graph.rods[-1].name == "rim"
    assert set(plan.graph.paired.tolist()) == set(range(13)) and plan.graph.joints == ()
    assert len(symmetries(design(), plan)) == 6 and len(plan.sample_points) == 13
    assert sorted(symmetries(design(), plan)[1].star.tolist()) == list(range(13))


def test_the_stars_are_those_without_the_rods() -> None:
    line = {"name": "line", "line_mm": [(25, -10), (25, 10)]}
    border = {"rings": 1}
    both = layout(design(rods={"draw": [line]}, border=border))
    alone = layout(Design.from_dict({"stars": STARS, "border": border}))
    for key in ("centres", "arm_tip", "arm_thickness", "outline", "star_number", "sample_pairs"):
        np.testing.assert_array_equal(getattr(both, key), getattr(alone, key))


def test_the_mesh_follows_arms_and_rods() -> None:
    plan = layout(design())
    mesh = mesh_layout(plan, 3.0)
    np.testing.assert_allclose(mesh.points[mesh.star_vertices], plan.centres, atol=1e-9)
    assert mesh.kind == "delaunay" and len(mesh.rods) == len(plan.graph.rods)
    ends = [mesh.points[rod[-1]] for rod in mesh.rods[: len(plan.arm_tip)]]
    np.testing.assert_allclose(ends, plan.arm_tip, atol=1e-9)


def test_arms_that_touch_a_line_are_refused_with_both_places() -> None:
    crossing = {"name": "line", "line_mm": [(-30, -4), (30, -4)]}
    with pytest.raises(DesignError, match=r"star at \[.*\] crosses line at \[.*, -4.00\]: shorten") as told:
        layout(design(rods={"draw": [crossing]}, border={"rings": 1}))
    assert len(told.value.stars) == 1
    beside = {"name": "line", "line_mm": [(-30, -7.5), (30, -7.5)]}
    with pytest.raises(DesignError, match=r"is 0.50 mm from line"):
        layout(design(rods={"draw": [beside]}, border={"rings": 1}))


def test_stars_keep_clear_of_holes_and_of_their_rims() -> None:
    window = {"name": "window", "circle_mm": {"radius": 6.0}}
    border = {"rods": "rim", "holes": [{"rods": "window"}]}
    plan = layout(design(rods={"draw": [RIM, window]}, border=border))
    assert len(plan.centres) == 12 and len(plan.hole_rims[0]) == 1
    assert plan.graph.rods[plan.hole_rims[0][0]].name == "window"


SIDE = 10.0
UP = SIDE * np.sqrt(0.75)
HONEYCOMB = Lattice(kind="custom", vectors_mm=[(1.5 * SIDE, UP), (1.5 * SIDE, -UP)])


def honeycomb(x: float = 0.0, y: float = 0.0) -> MotifGraph:
    ends = [(0.5 * SIDE, UP), (0.5 * SIDE, -UP), (-SIDE, 0.0)]
    lines = [{"line_mm": [(x, y), (x + end[0], y + end[1])]} for end in ends]
    return motif_graph(Rods.model_validate({"motif": lines}), HONEYCOMB)


def on_squares(*lines: dict[str, object]) -> MotifGraph:
    return motif_graph(Rods.model_validate({"motif": lines}), Lattice(kind="square", spacing_mm=10.0))


@pytest.mark.slow
@settings(max_examples=6, deadline=None, derandomize=True)
@given(x=st.floats(-50.0, 50.0), y=st.floats(-50.0, 50.0))
def test_a_honeycomb_has_two_nodes_and_three_rods_a_cell(x: float, y: float) -> None:
    graph = honeycomb(x, y)
    assert graph.ends_at.tolist() == [3, 3]
    assert [rod.length for rod in graph.rods] == pytest.approx([SIDE] * 3)
    np.testing.assert_array_equal(graph.end_image, honeycomb().end_image)
    for rod, image in zip(graph.rods, graph.end_image, strict=True):
        np.testing.assert_allclose(rod.points[0], graph.nodes[rod.start], atol=1e-9)
        np.testing.assert_allclose(rod.points[-1], graph.nodes[rod.end] + image @ graph.vectors, atol=1e-6)


def test_ends_in_rounded_numbers_meet_as_they_do_on_the_sheet() -> None:
    """The gallery's honeycomb misses its copies by 0.3 micrometres."""
    design = gallery.load("honeycomb")
    assert design.rods is not None
    graph = motif_graph(design.rods, design.lattice)
    assert graph.ends_at.tolist() == [3, 3]
    for rod, image in zip(graph.rods, graph.end_image, strict=True):
        np.testing.assert_array_equal(rod.points[0], graph.nodes[rod.start])
        np.testing.assert_array_equal(rod.points[-1], graph.nodes[rod.end] + image @ graph.vectors)


@pytest.mark.parametrize(
    ("line", "ends", "image"),
    [
        ({"line_mm": [(0, 0), (10, 0)]}, [2], [[1, 0]]),  # goes on as its copy
        ({"line_mm": [(0, 0), (6, 0)]}, [1, 1], [[0, 0]]),  # ends freely
        ({"circle_mm": {"radius": 3.0}}, [2], [[0, 0]]),  # closed
    ],
)
def test_lines_of_all_kinds(line: dict[str, object], ends: list[int], image: list[list[int]]) -> None:
    graph = on_squares(line)
    assert graph.ends_at.tolist() == ends and graph.end_image.tolist() == image


def test_lines_that_cross_copies_of_each_other_are_cut_there() -> None:
    graph = on_squares({"line_mm": [(-4, 1), (6, 1)]}, {"line_mm": [(11, -5), (11, 5)]})
    assert sum(rod.length for rod in graph.rods) == pytest.approx(20.0)
    assert sorted(graph.ends_at.tolist()) == [2, 2, 4]


def test_a_motif_that_lies_on_its_copies_is_refused() -> None:
    with pytest.raises(DesignError, match="two lines named long lie on each other"):
        on_squares({"name": "long", "line_mm": [(0, 0), (13, 0)]})
    with pytest.raises(DesignError, match=r"^rods\.motif: is too long for its lattice"):
        on_squares({"line_mm": [(0, 0), (700, 31)]})


OUTER = {"name": "rim", "circle_mm": {"radius": 30.0}}
EYE = {"name": "eye", "spline_mm": [[-6, 0], [0, 6], [6, 0], [0, -6]], "closed": True}
DESIGNS: list[dict[str, Any]] = [
    {
        "rods": {"draw": [OUTER, EYE, {"name": "rib", "line_mm": [[-35, 1], [35, 1]]}], "thickness_mm": 0.4},
        "border": {"rods": "rim", "holes": [{"rods": "eye"}, {"circle_mm": {"centre": [0, -15], "radius": 4.0}}]},
        "pins": [{"points_mm": [[20, -5], [-20, -5]]}],
        "mesh": {"edge_mm": 5.0},
    },
    {
        "lattice": {"kind": "square", "spacing_mm": 10.0},
        "rods": {"motif": [{"line_mm": [[0, 0], [10, 0]]}, {"line_mm": [[0, 0], [0, 10]]}]},
        "border": {"rectangle_mm": [42.0, 42.0], "holes": [{"polygon_mm": [[2, 2], [8, 2], [8, 8], [2, 8]]}]},
        "mesh": {"edge_mm": 5.0},
    },
    {
        "stars": {"length_mm": 7.0, "thickness_mm": 0.4},
        "rods": {"draw": [OUTER | {"circle_mm": {"radius": 40.0}}]},
        "border": {"rods": "rim", "star_margin_mm": 9.0},
        "mesh": {"edge_mm": 5.0},
    },
]
KEYS = ("radius", "closed", "line_mm", "join_mm", "curve_mm", "holes", "rods", "layer", "file")
# larger sheets and finer meshes take long, and show nothing else
MAX_VERTICES = 20_000


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 60, 20))
def test_a_mutated_design_is_meshed_or_refused_in_one_line(first: int) -> None:
    for number in range(first, first + 20):
        table, rng = DESIGNS[number % len(DESIGNS)], np.random.default_rng([7, number])
        for _ in range(1 + number % 2):
            table = mutated_table(table, rng, KEYS)
        try:
            design = Design.from_dict(table)
            plan = layout(design)
            if np.prod(np.ptp(plan.outline, axis=0)) / design.mesh.edge_mm**2 > MAX_VERTICES:
                continue
            mesh = mesh_layout(plan, design.mesh.edge_mm, design.mesh.kind)
            assert triangle_areas(mesh.points, mesh.triangles).min() > 0.0
        except Error as error:
            assert str(error) and "\n" not in str(error)
