"""Nearest points on a triangulated surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.normals import triangle_normals

# points that are computed in one array
_POINTS_AT_ONCE = 20_000


@dataclass(frozen=True)
class Nearest:
    """The nearest points on a surface to some points."""

    places: Floats  # (n, 3) mm, nearest points on the surface
    triangle: Ints  # (n,) triangles that contain them
    distance: Floats  # (n,) mm, positive on the side of the normals


class NearestOnSurface:
    """Search for the nearest points on triangles (T, 3) with vertices (V, 3) mm."""

    def __init__(self, vertices: Floats, triangles: Ints):
        self.vertices, self.triangles, self._corners = vertices, triangles, vertices[triangles]
        normals = triangle_normals(vertices, triangles)
        self.normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        centres = self._corners.mean(axis=1)
        size = np.linalg.norm(self._corners - centres[:, None], axis=2).max(axis=1)
        # triangles of one kind differ in size by a factor of 2 at most
        kind = np.floor(np.log(np.maximum(size, 1e-9) / max(size.max(), 1e-9)) / np.log(2.0)).astype(int)
        self._kinds = [(cKDTree(centres[kind == k]), np.flatnonzero(kind == k)) for k in np.unique(kind)]

    def __call__(self, points: Floats) -> Nearest:
        """The nearest points to points (n, 3) mm."""
        chunks = [self._some(points[i : i + _POINTS_AT_ONCE]) for i in range(0, len(points), _POINTS_AT_ONCE)]
        places, triangle = (np.concatenate(parts) for parts in zip(*chunks, strict=True))
        away = points - places
        side = np.where(np.einsum("ni,ni->n", away, self.normals[triangle]) < 0, -1.0, 1.0)
        return Nearest(places, triangle, side * np.linalg.norm(away, axis=1))

    def _some(self, points: Floats) -> tuple[Floats, Ints]:
        from trimesh.triangles import closest_point  # slow to import

        # of each kind, the triangles with the nearest centres
        near = [among[tree.query(points, k=range(1, min(12, len(among)) + 1))[1]] for tree, among in self._kinds]
        candidates = np.concatenate(near, axis=1)
        there = closest_point(self._corners[candidates.ravel()], np.repeat(points, candidates.shape[1], axis=0))
        places = there.reshape(*candidates.shape, 3)
        # triangles without area give nan in older releases of trimesh
        best = np.nan_to_num(((places - points[:, None, :]) ** 2).sum(axis=2), nan=np.inf).argmin(axis=1)
        rows = np.arange(len(points))
        return places[rows, best], candidates[rows, best]
