"""Nearest points on a triangulated surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.normals import triangle_normals

# triangles of one size that are tried for each point: those with the nearest centres
_CANDIDATES_A_SIZE = 12
# largest ratio of sizes within one group of triangles
_SIZE_RATIO = 2.0
# points that are computed in one array
_POINTS_AT_ONCE = 20_000


@dataclass(frozen=True)
class Nearest:
    """The nearest points on a surface to some points.

    Attributes
    ----------
    places : (n, 3) mm, nearest points on the surface.
    triangle : (n,) triangles that contain them.
    distance : (n,) mm, positive on the side of the normals.
    """

    places: Floats
    triangle: Ints
    distance: Floats


class NearestOnSurface:
    """Search for the nearest points on triangles (T, 3) with vertices (V, 3) mm."""

    def __init__(self, vertices: Floats, triangles: Ints):
        self._triangles = triangles
        self._corners = vertices[triangles]
        normals = triangle_normals(vertices, triangles)
        self.normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        centres = self._corners.mean(axis=1)
        size = np.linalg.norm(self._corners - centres[:, None], axis=2).max(axis=1)
        kind = np.floor(np.log(np.maximum(size, 1e-9) / max(size.max(), 1e-9)) / np.log(_SIZE_RATIO)).astype(int)
        self._kinds = [(cKDTree(centres[kind == k]), np.flatnonzero(kind == k)) for k in np.unique(kind)]

    def __call__(self, points: Floats) -> Nearest:
        """The nearest points to points (n, 3) mm."""
        chunks = [self._some(points[i : i + _POINTS_AT_ONCE]) for i in range(0, len(points), _POINTS_AT_ONCE)]
        places, triangle = (np.concatenate(parts) for parts in zip(*chunks, strict=True))
        away = points - places
        side = np.where(np.einsum("ni,ni->n", away, self.normals[triangle]) < 0, -1.0, 1.0)
        return Nearest(places, triangle, side * np.linalg.norm(away, axis=1))

    def _some(self, points: Floats) -> tuple[Floats, Ints]:
        candidates = np.concatenate([_nearest(tree, among, points) for tree, among in self._kinds], axis=1)
        places = nearest_in_triangles(points[:, None, :], self._corners[candidates])
        best = ((places - points[:, None, :]) ** 2).sum(axis=2).argmin(axis=1)
        rows = np.arange(len(points))
        return places[rows, best], candidates[rows, best]


def _nearest(tree: cKDTree, among: Ints, points: Floats) -> Ints:
    """(n, k) triangles of one size with the nearest centres."""
    count = min(_CANDIDATES_A_SIZE, len(among))
    return np.asarray(among[tree.query(points, k=count)[1].reshape(len(points), count)])


def nearest_in_triangles(points: Floats, corners: Floats) -> Floats:
    """(..., 3) nearest point on each triangle (..., 3, 3) to its point (..., 3).

    Reference: Ericson, Real-Time Collision Detection, 2005, section 5.1.5.
    """
    a, b, c = (corners[..., k, :] for k in range(3))
    ab, ac = b - a, c - a
    d1, d2 = _dot(ab, points - a), _dot(ac, points - a)
    d3, d4 = _dot(ab, points - b), _dot(ac, points - b)
    d5, d6 = _dot(ab, points - c), _dot(ac, points - c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    inside = np.maximum(va + vb + vc, 1e-300)
    v, w = vb / inside, vc / inside
    # from the inside outwards: each region replaces the results of earlier ones
    for region, new_v, new_w in (
        ((va <= 0) & (d4 - d3 >= 0) & (d5 - d6 >= 0), 1 - _share(d4 - d3, d5 - d6), _share(d4 - d3, d5 - d6)),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), 0.0, _share(d2, -d6)),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), _share(d1, -d3), 0.0),
        ((d6 >= 0) & (d5 <= d6), 0.0, 1.0),
        ((d3 >= 0) & (d4 <= d3), 1.0, 0.0),
        ((d1 <= 0) & (d2 <= 0), 0.0, 0.0),
    ):
        v, w = np.where(region, new_v, v), np.where(region, new_w, w)
    return a + v[..., None] * ab + w[..., None] * ac


def _dot(x: Floats, y: Floats) -> Floats:
    return np.asarray(np.einsum("...i,...i->...", x, y))


def _share(one: Floats, other: Floats) -> Floats:
    return one / np.where(one + other > 0, one + other, 1.0)
