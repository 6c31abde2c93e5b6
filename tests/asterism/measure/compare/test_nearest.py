"""Nearest places on triangles, against another implementation."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial import Delaunay

from asterism.measure.compare.nearest import NearestOnSurface
from tests.asterism.sheets import saddle, sheet


def test_on_a_sheet_with_its_side() -> None:
    shape = sheet(saddle, edge=4.0)
    surface = NearestOnSurface(shape.positions, shape.triangles)
    middles = shape.positions[shape.triangles].mean(axis=1)
    above = surface(middles + 0.3 * surface.normals)
    np.testing.assert_allclose(above.distance, 0.3, atol=0.02)
    np.testing.assert_allclose(surface(middles - 0.3 * surface.normals).distance, -0.3, atol=0.02)
    points = middles + np.random.default_rng(0).normal(size=middles.shape)
    corners = shape.positions[shape.triangles]
    every = np.array(
        [
            np.linalg.norm(trimesh.triangles.closest_point(corners, np.tile(p, (len(corners), 1))) - p, axis=1).min()
            for p in points[::25]
        ]
    )
    np.testing.assert_allclose(np.abs(surface(points[::25]).distance), every, atol=1e-9)


def test_beside_small_triangles_a_large_one_is_found() -> None:
    """A sheet whose triangles grow from one side to the other, by two orders of magnitude."""
    rng = np.random.default_rng(4)
    x, y = 60.0 * rng.random(1500) ** 3, 20.0 * rng.random(1500)
    vertices = np.column_stack([x, y, 0.1 * x * np.sin(0.3 * y)])
    triangles = Delaunay(vertices[:, :2]).simplices
    surface, corners = NearestOnSurface(vertices, triangles), vertices[triangles]
    points = vertices[::7] + rng.normal(0.0, 2.0, (len(vertices[::7]), 3))
    every = [
        np.linalg.norm(trimesh.triangles.closest_point(corners, np.tile(p, (len(corners), 1))) - p, axis=1).min()
        for p in points
    ]
    np.testing.assert_allclose(np.abs(surface(points).distance), every, atol=1e-9)
