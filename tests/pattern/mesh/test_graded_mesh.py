"""Meshes that are finer at arms and tips, of every kind of sheet."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from asterism.discrete.energies.bending.plate import patches
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import triangle_angles, triangle_areas
from asterism.pattern.layout.build import layout as layout_of
from asterism.pattern.mesh.graded_mesh import GRADED_EDGE_FACTOR, MIN_GRADED_ANGLE_DEG, MIN_KEPT_ANGLE, Grading
from asterism.pattern.mesh.meshing import mesh_layout
from tests.pattern.layouts import L_SHAPE, RECTANGLE, ROUND, SIX, SLANTED, THREE, D, pin, rings, stars_on, unit
from tests.pattern.mesh_rules import obey, smallest_angle

TRIANGLE = np.array([[-60, -40], [60, -35], [5, 60]], dtype=float)
T_SHAPE = np.array([[-60, 10], [-20, 10], [-20, -50], [20, -50], [20, 10], [60, 10], [60, 45], [-60, 45]], dtype=float)


def heights(mesh):
    """(n,) mm, of triangles over their sides on rods."""
    n, t = len(mesh.points), mesh.triangles
    sides = np.concatenate([np.column_stack([rod[:-1], rod[1:]]) for rod in mesh.rods])
    corner = np.concatenate([np.roll(t, k, axis=1) for k in range(3)])
    on = np.isin(np.sort(corner[:, 1:], axis=1) @ [n, 1], np.sort(sides, axis=1) @ [n, 1])
    length = np.linalg.norm(mesh.points[corner[on, 2]] - mesh.points[corner[on, 1]], axis=1)
    return 2.0 * triangle_areas(mesh.points, corner[on]) / length


def sound(sheet, edge, kind="auto"):
    """The even mesh of a sheet and the graded one, which has the same triangles, of which none is flat."""
    even, mesh = (mesh_layout(sheet, edge, kind, graded=graded) for graded in (False, True))
    obey(sheet, even)
    obey(sheet, mesh)
    assert np.array_equal(mesh.triangles, even.triangles)
    before, after = (triangle_angles(each.points, each.triangles).min(axis=1) for each in (even, mesh))
    assert (after >= np.minimum(MIN_GRADED_ANGLE_DEG, MIN_KEPT_ANGLE * before)).all()
    return even, mesh


def finer_at_arms(even, mesh):
    """Whether the lowest quarter of the triangles on rods is at most 0.85 times as high as that of the even mesh."""
    return np.quantile(heights(mesh), 0.25) < 0.85 * np.quantile(heights(even), 0.25)


@pytest.mark.slow
@pytest.mark.parametrize("k", [7, 14])
@pytest.mark.parametrize("length", [7.0, 13.0])
@pytest.mark.parametrize("kind", ["aligned", "delaunay"])
def test_the_same_triangles_but_finer_at_the_arms(k, length, kind):
    even, mesh = sound(rings(1, length), D / k, kind)
    assert mesh.kind == kind and finer_at_arms(even, mesh)


@pytest.mark.slow
@pytest.mark.parametrize("border", [L_SHAPE, SLANTED, RECTANGLE, ROUND, TRIANGLE, T_SHAPE])
@pytest.mark.parametrize("length", [6.0, 13.0])
@pytest.mark.parametrize("edge", [2.4, 5.0])
def test_any_outline_stays_aligned(border, length, edge):
    even, mesh = sound(stars_on(border, length, margin=0.5), edge)
    assert mesh.kind == even.kind and (edge == 5.0 or mesh.kind == "aligned")
    assert edge == 5.0 or finer_at_arms(even, mesh)
    patches(mesh.triangles, mesh.points)


@pytest.mark.slow
@pytest.mark.parametrize("gap", [0.1, 0.5, 1.0])
def test_arms_that_end_just_inside_the_outline(gap):
    for kind in ("auto", "delaunay"):
        sound(rings(1, 15.0 - gap), 2.4, kind)


def test_pins_stay():
    pins = (pin([[3.3, 6.1], [40, 32], [40, 3.1], [-12, 14]]), pin(edges=(1, 2)))
    sound(stars_on(RECTANGLE, 8.0, pins=pins), 2.4, "aligned")


@pytest.mark.parametrize(
    "more",
    [
        {"border": {"rectangle_mm": (70.0, 50.0), "holes": [{"circle_mm": {"radius": 8.0}}]}},
        {"lattice": {"orientation_deg": 17.0}, "border": {"rectangle_mm": (70.0, 50.0)}},
    ],
)
def test_holes_and_turned_stars(more):
    sheet = layout_of(Design.from_dict({"stars": {"length_mm": 8.0}, **more}))
    even, mesh = (mesh_layout(sheet, 2.4, graded=graded) for graded in (False, True))
    assert mesh.kind == "delaunay" and finer_at_arms(even, mesh)
    assert smallest_angle(mesh) >= min(MIN_GRADED_ANGLE_DEG, MIN_KEPT_ANGLE * smallest_angle(even))
    for hole in mesh.hole_vertices:
        assert np.array_equal(mesh.points[hole], even.points[hole])


def test_drawn_rods_crowd_at_free_ends_only():
    lines = [{"line_mm": [[-20.0, 0.0], [20.0, 0.0]]}, {"line_mm": [[0.0, 0.0], [0.0, 20.0]]}]
    sheet = layout_of(Design.from_dict({"rods": {"draw": lines}, "border": {"rectangle_mm": (60.0, 60.0)}}))
    even, mesh = (mesh_layout(sheet, 2.5, graded=graded) for graded in (False, True))
    assert finer_at_arms(even, mesh)
    assert smallest_angle(mesh) >= MIN_GRADED_ANGLE_DEG
    for rod in mesh.rods:
        steps = np.linalg.norm(np.diff(mesh.points[rod], axis=0), axis=1)
        free = 0 if np.linalg.norm(mesh.points[rod[0]]) > 10.0 else -1  # the other end is the joint
        assert steps[free] < 0.7 * steps[-1 - free]


def test_vertices_crowd_at_the_tip():
    grading = Grading.of(rings(1, 10.0))
    steps = np.diff(grading.along(10.0, 40)) * 10.0
    assert (np.diff(steps) <= 1e-9).all()
    assert steps[-1] / steps[0] == pytest.approx(GRADED_EDGE_FACTOR, rel=0.15)
    assert steps.sum() == pytest.approx(10.0)


@pytest.mark.slow
@settings(max_examples=10)
@given(st.data())
def test_any_polygon(data):
    """Star-shaped outlines with stars of any length and direction: sound meshes, or one line that says why not."""
    radii = data.draw(st.lists(st.floats(20, 60), min_size=3, max_size=12))
    border = np.array(radii)[:, None] * unit([360.0 * q / len(radii) for q in range(len(radii))])
    directions = data.draw(st.sampled_from([THREE, SIX, (5.0, 95.0, 185.0, 275.0)]))
    sheet = stars_on(border, data.draw(st.floats(0.5, 16)), directions)
    assume(len(sheet.centres))
    edge, kind = data.draw(st.floats(1.5, 8.0)), data.draw(st.sampled_from(["auto", "delaunay"]))
    try:
        mesh_layout(sheet, edge, kind)
    except MeshError:
        return
    sound(sheet, edge, kind)
