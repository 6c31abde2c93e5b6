"""The map from the print to the target: place, contraction and curvature that each printed point should have."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.fitting.flatten import FlatDisk
from asterism.pattern.geometry.point_location import TriangleFinder, clipped
from asterism.shape.surface_fields import directed_edges


@dataclass(frozen=True, eq=False)
class TargetMap:
    """A flattened target on the print."""

    flat: FlatDisk  # the flattening
    printed: Floats  # (V, 2) mm, printed positions of the vertices of the target
    spacing_mm: float  # of the stars

    @cached_property
    def log_contraction(self) -> Floats:
        """(V,) logarithm of the contraction that each vertex needs: length on the target over length on the print."""
        disk = self.flat.disk
        a, b = directed_edges(disk.triangles).T
        on_target, on_print = (np.linalg.norm(p[b] - p[a], axis=1) for p in (disk.vertices, self.printed))
        # the size that the map really has, with its closing correction; u gives the rest, without noise of the mesh
        level = float(np.log(on_target.sum() / on_print.sum()))
        mean_u = 0.5 * (self.flat.log_scale[a] + self.flat.log_scale[b])
        middle = float(np.average(mean_u, weights=on_target))
        return np.asarray(level - (self.flat.log_scale - middle))

    @cached_property
    def _finder(self) -> TriangleFinder:
        return TriangleFinder(self.printed, self.flat.disk.triangles)

    def interpolate(self, values: Floats, points: Floats) -> Floats:
        """(n, ...) values (V, ...) of the vertices at printed points (n, 2); outside, of the nearest triangle."""
        triangle, weights = self._finder.nearest(points)
        corners = values[self.flat.disk.triangles[triangle]]
        return np.asarray(np.einsum("nk,nk...->n...", clipped(weights), corners))

    def places(self, points: Floats) -> Floats:
        """(n, 3) mm, where the target has the printed points (n, 2)."""
        return self.interpolate(self.flat.disk.vertices, points)

    def principal_curvatures(self, points: Floats) -> Floats:
        """(n, 2) 1/mm at printed points (n, 2), the larger first, positive where the plastic side is convex.

        They are those of the quadric `x(X)` that fits the target around each point best, so that noise and features
        smaller than a cell do not count.
        """
        # of the spacing: distance of the points through which the quadric goes
        step = 0.2 * self.spacing_mm
        low, high = self.printed.min(axis=0), self.printed.max(axis=0)
        grid = np.stack(np.meshgrid(*(np.arange(a, b + step, step) for a, b in zip(low, high, strict=True))), axis=-1)
        samples = grid.reshape(-1, 2)
        triangle, weights = self._finder.nearest(samples)
        on_target = weights.min(axis=1) > -1e-9
        samples = samples[on_target]
        places = np.einsum(
            "nk,nkc->nc", weights[on_target], self.flat.disk.vertices[self.flat.disk.triangles[triangle[on_target]]]
        )
        tree = cKDTree(samples)
        result = np.zeros((len(points), 2))
        # of the spacing: curvatures are those of a quadric through the target within this distance on the print
        for row, near in enumerate(tree.query_ball_point(points, 0.9 * self.spacing_mm)):
            # twice the coefficients of a quadric; places with fewer points around have no curvature
            if len(near) >= 12:
                result[row] = _quadric_curvatures(samples[near] - points[row], places[near])
        return result


def _quadric_curvatures(shift: Floats, places: Floats) -> Floats:
    """(2,) principal curvatures at the origin of the quadric through places (n, 3) at shifts (n, 2)."""
    x, y = shift.T
    terms = np.column_stack([np.ones_like(x), x, y, 0.5 * x**2, 0.5 * y**2, x * y])
    _, along_x, along_y, xx, yy, xy = np.linalg.lstsq(terms, places, rcond=None)[0]
    normal = np.cross(along_x, along_y)
    length = np.linalg.norm(normal)
    if not length > 0.0:
        return np.zeros(2)
    first = np.array([[along_x @ along_x, along_x @ along_y], [along_x @ along_y, along_y @ along_y]])
    second = -np.array([[xx, xy], [xy, yy]]) @ normal / length
    return np.asarray(np.sort(np.linalg.eigvals(np.linalg.solve(first, second)).real)[::-1])
