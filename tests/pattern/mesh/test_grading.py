"""Meshes that are finer at arms and tips."""

from __future__ import annotations

import numpy as np
import pytest

from asterism.pattern.design.errors import MeshError
from asterism.pattern.mesh.aligned.aligned_mesh import MIN_GRADED_ANGLE_DEG, aligned_mesh
from asterism.pattern.mesh.free.delaunay_mesh import delaunay_mesh
from asterism.pattern.mesh.grading import GRADED_EDGE_FACTOR, Grading
from tests.pattern.layouts import L_SHAPE, D, rings, stars_on, unit
from tests.pattern.mesh_rules import obey, same_after, smallest_angle


def sizes(mesh):
    """Heights (T,) of triangles over their longest edge, mm, and their middles."""
    corner = mesh.points[mesh.triangles]
    edges = np.linalg.norm(np.roll(corner, -1, axis=1) - corner, axis=2)
    e1, e2 = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return np.abs(e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0]) / edges.max(axis=1), corner.mean(axis=1)


@pytest.mark.parametrize("k", [6, 8, 12])
@pytest.mark.parametrize("length", [6.0, 10.0, 13.0])
def test_as_many_triangles_but_finer_at_the_arms(k, length):
    sheet = rings(1, length)
    even, mesh = aligned_mesh(sheet, D / k), aligned_mesh(sheet, D / k, graded=True)
    obey(sheet, mesh)
    assert len(mesh.triangles) == len(even.triangles)
    assert smallest_angle(mesh) > MIN_GRADED_ANGLE_DEG
    height, middle = sizes(mesh)
    near = Grading.of(sheet).size(middle) < 0.5
    assert near.any()
    assert np.median(height[near]) < 0.75 * np.median(sizes(even)[0])


def test_vertices_crowd_at_the_tip():
    grading = Grading.of(rings(1, 10.0))
    steps = np.diff(grading.along(10.0, 40)) * 10.0
    assert (np.diff(steps) <= 1e-9).all()
    assert steps[-1] / steps[0] == pytest.approx(GRADED_EDGE_FACTOR, rel=0.15)
    assert steps.sum() == pytest.approx(10.0)


def test_symmetric():
    mesh = aligned_mesh(rings(2, 10.0), 2.0, graded=True)
    turn = np.array([unit(120.0), unit(210.0)])
    assert same_after(mesh, mesh.points @ turn)
    assert same_after(mesh, mesh.points * [-1, 1])


def test_delaunay_has_small_triangles_beside_arms():
    sheet = rings(1, 10.0)
    mesh = delaunay_mesh(sheet, 3.0, 0, graded=True)
    obey(sheet, mesh)
    assert smallest_angle(mesh) > 20.0
    height, middle = sizes(mesh)
    size = Grading.of(sheet).size(middle)
    assert np.median(height[size < 0.3]) < 0.4 * np.median(height[size == 1.0])


def test_borders_that_are_no_hexagon_are_left_to_delaunay():
    with pytest.raises(MeshError, match="hexagonal"):
        aligned_mesh(stars_on(L_SHAPE, 9.0), 2.0, graded=True)
