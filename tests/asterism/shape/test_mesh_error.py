"""The estimate of the discretisation error, on shapes whose error is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.results.records.exact import mesh_error_in_words
from asterism.shape.mesh_error import estimate, mesh_error
from asterism.shape.shape import Shape
from tests.distances import rms_distance


def bowl(cells: int, height: float) -> Shape:
    """A square of 20 mm bent to a paraboloid, somewhere in space."""
    side = np.linspace(-10.0, 10.0, cells + 1)
    points = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    lower = np.column_stack([corner, corner + cells + 1, corner + cells + 2])
    upper = np.column_stack([corner, corner + cells + 2, corner + 1])
    space = np.column_stack([points, height * (points**2).sum(axis=1) / 200.0])
    turn = Rotation.from_rotvec([0.3 * cells, 1.0, -0.2]).as_matrix()
    none = np.full(len(points), -1)
    return Shape(points, space @ turn.T + cells, np.concatenate([lower, upper]), none, (), none[:0])


@pytest.mark.parametrize("order", [1.0, 2.0])
def test_error_of_a_height_that_converges(order):
    """Height 5 + c edge^p on two meshes: the estimate is the distance to the limit, wherever the sheets lie."""
    shapes = {n: bowl(n, 5.0 * (1.0 + 0.2 * (20.0 / n) ** order)) for n in (20, 40)}
    limit = bowl(40, 5.0)
    exact = 100.0 * rms_distance(shapes[40].positions, limit.positions) / diameter(shapes[40].positions)
    found = mesh_error(shapes[40], [(shapes[20].printed, shapes[20].positions)], order=order)
    assert found.percent == pytest.approx(exact, rel=0.2)
    assert found.order is None
    assert found.change == pytest.approx((2.0**order - 1.0) * exact, rel=0.2)


@pytest.mark.parametrize("order", [0.7, 1.0, 2.0])
def test_three_meshes_show_their_order(order):
    shapes = {n: bowl(n, 5.0 * (1.0 + 0.2 * (20.0 / n) ** order)) for n in (32, 56, 96)}
    exact = 100.0 * rms_distance(shapes[96].positions, bowl(96, 5.0).positions) / diameter(shapes[96].positions)
    found = mesh_error(shapes[96], [(shapes[n].printed, shapes[n].positions) for n in (32, 56)])
    assert found.order == pytest.approx(order, abs=0.15)
    assert found.percent == pytest.approx(exact, rel=0.3)


@pytest.mark.parametrize(("order", "believed"), [(0.3, False), (0.6, True), (2.4, True), (3.0, False)])
def test_orders_that_theory_does_not_know_are_not_believed(order, believed):
    edges = [3.0, 1.7, 1.0]
    distances = [2.0 * (edge**order - 1.0) for edge in edges[:2]]
    found = estimate(edges, distances)
    assert found.order == pytest.approx(order) and found.change == distances[1]
    assert found.percent == (pytest.approx(2.0) if believed else None)


def test_meshes_that_do_not_see_the_creases_show_no_error():
    """However well they agree: the shape that they agree on may be a wrong one."""
    assert estimate([2.0, 1.0], [0.1], resolved=False).percent is None
    found = estimate([4.0, 2.0, 1.0], [0.3, 0.1], resolved=False)
    assert found.percent is None and found.change == 0.1 and found.order == pytest.approx(1.0)


def test_distances_that_do_not_fall_have_no_order():
    found = estimate([3.0, 1.7, 1.0], [1.0, 1.1])
    assert found.order is None and found.percent is None and found.change == 1.1
    # two different minima
    assert estimate([1.7, 1.0], [11.0]).percent is None


def test_no_estimate_from_meshes_or_shapes_that_do_not_go_together():
    fine, coarse = bowl(20, 5.0), bowl(10, 5.0)
    assert mesh_error(fine, [(coarse.printed, coarse.positions)]).percent == pytest.approx(0.0, abs=0.2)
    # the other branch, and the same mesh
    assert mesh_error(fine, [(coarse.printed, bowl(10, -8.0).positions)]).percent is None
    assert mesh_error(fine, [(fine.printed, fine.positions)]).percent is None
    assert mesh_error(fine, []).change is None


@pytest.mark.parametrize(("pins", "is_free"), [([], True), ([{"where": "border"}], False)])
def test_supported_sheets_differ_as_their_supports_hold_them(pins, is_free):
    """A coarser shape that has turned differs if supports fix both, and if they are free it does not."""
    border = {"polygon_mm": [[-10.0, -10.0], [10.0, -10.0], [10.0, 10.0], [-10.0, 10.0]], "star_margin_mm": 1.0}
    plan = layout(Design.from_dict({"stars": {"length_mm": 4.0}, "border": border, "pins": pins}))
    fine, coarse = bowl(20, 5.0), bowl(10, 5.0)
    turned = fine.at(coarse.printed) @ Rotation.from_euler("z", 5.0, degrees=True).as_matrix().T
    change = mesh_error(fine, [(coarse.printed, turned)], layout=plan).change
    assert (change < 1e-6) is is_free and (change > 1.0) is not is_free


def test_diameter():
    assert diameter(bowl(20, 0.0).positions) == pytest.approx(np.sqrt(800.0))
    assert diameter(bowl(20, 5.0).positions) == pytest.approx(np.sqrt(800.0), rel=1e-2)


def solved(edge, rings, **changes):
    data = gallery.load("tube").to_dict() | {"border": {"rings": rings}, "mesh": {"edge_mm": edge}} | changes
    return exact_shape(Design.from_dict(data))


@pytest.mark.slow
def test_summary_says_it_when_two_levels_were_solved():
    two = solved(0.5, 0).summary
    assert len(two["levels"]) == 2 and two["creases_resolved"]
    assert two["edge_at_arms_mm"] < two["crease_mm"]
    assert 0.0 < two["mesh_error_percent"] < 5.0
    assert mesh_error_in_words(two) == f"about {two['mesh_error_percent']:.1f} % of the diameter"
    assert all(isinstance(value, int | float | dict) for level in two["levels"] for value in level.values())
    one = solved(3.0, 0).summary
    assert one["mesh_error_percent"] is None and one["mesh_change_percent"] is None
    assert mesh_error_in_words(one) == "not known, one mesh was solved"


@pytest.mark.slow
def test_no_error_is_claimed_where_the_mesh_does_not_resolve_the_creases():
    """The plate's creases are narrower than these triangles: from mesh to mesh the shape changes less than it errs."""
    plate = gallery.load("tube").to_dict()["fabric"] | {"bending": "consistent"}
    coarse, fine = solved(1.05, 1, fabric=plate), solved(0.75, 1, fabric=plate)
    s = coarse.summary
    assert not s["creases_resolved"] and s["mesh_error_percent"] is None
    error = 100.0 * rms_distance(fine.at(coarse.printed), coarse.positions) / diameter(fine.positions)
    assert 0.0 < s["mesh_change_percent"] < min(error, fine.summary["mesh_change_percent"])
    assert mesh_error_in_words(s).startswith("not known, the mesh does not resolve the creases; ")


@pytest.mark.slow
def test_summary_says_which_bending_was_used():
    data = gallery.load("star").to_dict()
    energy = {}
    plate = {"plate", "folds"}
    for bending, parts in (("paper", {"hinges"}), ("plate", plate), ("consistent", plate), ("none", set())):
        data["fabric"] = data["fabric"] | {"bending": bending}
        summary = exact_shape(Design.from_dict(data)).summary
        assert summary["fabric_bending"] == bending and summary["is_minimum"]
        assert {"hinges", "plate", "folds"} & set(summary["energy_parts_n_mm"]) == parts
        energy[bending] = summary["fabric_bending_n_mm"]
        assert energy[bending] == pytest.approx(sum(summary[part] for part in parts))
    assert energy["paper"] == pytest.approx(energy["plate"], rel=0.1)
    assert energy["plate"] > energy["consistent"] > energy["none"] == 0.0


def test_shapes_with_a_wavy_hole_are_compared() -> None:
    a = np.linspace(0.0, 2.0 * np.pi, 30, endpoint=False)
    r = 8.0 * (1.0 + 0.25 * np.cos(3.0 * a))
    hole = {"spline_mm": np.column_stack([r * np.cos(a), r * np.sin(a)]).tolist()}
    border = {"rectangle_mm": (40.0, 40.0), "holes": [hole]}
    lines = [{"line_mm": [(-19, y), (19, y)]} for y in (-15, 15)]
    plan = print_layout(Design.from_dict({"rods": {"draw": lines}, "border": border}))
    meshes = [mesh_layout(plan, edge) for edge in (3.0, 2.0, 1.0)]
    places = [np.column_stack([mesh.points, 0.01 * mesh.points[:, 0] ** 2]) for mesh in meshes]
    none = np.full(len(meshes[-1].points), -1)
    fine = Shape(
        meshes[-1].points, places[-1], meshes[-1].triangles, none, meshes[-1].rods, np.empty(0, dtype=np.int64)
    )
    coarser = [(mesh.points, where) for mesh, where in zip(meshes[:-1], places[:-1], strict=True)]
    with pytest.raises(ValueError, match="off the sheet"):
        fine.at(meshes[0].points)
    assert 0.0 < mesh_error(fine, coarser, True, layout=plan).change < 0.5
