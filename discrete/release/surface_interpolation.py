"""Places of a sheet between the vertices of a mesh."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import ConvexHull

from discrete.energies.elements import Array
from pattern.geometry.arrays import Ints
from pattern.geometry.planar import distance_to_segment, triangle_areas

MAX_MISSING_HULL_FRACTION = 1e-6  # part of the convex hull that a convex sheet may lack


def interpolate_surface(printed: Array, triangles: Ints, positions: Array, points: Array, smooth: bool) -> Array:
    """(n, 3) mm, where a sheet takes printed points (n, 2).

    Parameters
    ----------
    printed, positions : (V, 2) and (V, 3) mm, of the vertices.
    triangles : (T, 3).
    smooth : C1 cubics (Clough and Tocher) with the gradients that bend least; else flat triangles.

    Notes
    -----
    scipy's interpolators know points and no triangles: in a sheet with a notch they mix what lies across it. There the
    cubics are matplotlib's, on the sheet's own triangles.
    """
    area = np.abs(triangle_areas(printed, triangles)).sum()
    if area > (1.0 - MAX_MISSING_HULL_FRACTION) * ConvexHull(printed).volume:
        interpolator = CloughTocher2DInterpolator if smooth else LinearNDInterpolator
        found = interpolator(printed, positions, rescale=True)(points)
        off = np.isnan(found).any(axis=1)
        if off.any():
            nearest = NearestNDInterpolator(printed, positions - _lifted(printed))
            found[off] = nearest(points[off]) + _lifted(points[off])
        return np.asarray(found)
    return _on_triangles(printed, triangles, positions, points, smooth)


def _on_triangles(printed: Array, triangles: Ints, positions: Array, points: Array, smooth: bool) -> Array:
    from matplotlib.tri import CubicTriInterpolator, LinearTriInterpolator, Triangulation  # slow to load

    mesh = Triangulation(printed[:, 0], printed[:, 1], triangles)
    finder = mesh.get_trifinder()
    found = np.empty((len(points), 3))
    for axis, values in enumerate(positions.T):
        within = (CubicTriInterpolator if smooth else LinearTriInterpolator)(mesh, values, trifinder=finder)
        found[:, axis] = np.ma.filled(within(*points.T), np.nan)
    off = np.flatnonzero(np.isnan(found).any(axis=1))
    if len(off):  # as the nearest triangle goes on
        triangle, side = np.nonzero(mesh.neighbors == -1)
        ends = [printed[triangles[triangle, (side + k) % 3]] for k in (0, 1)]
        corners = triangles[triangle[distance_to_segment(points[off, None], *ends).argmin(axis=1)]]
        origin, sides = printed[corners[:, 0]], printed[corners[:, 1:]] - printed[corners[:, :1]]
        part = np.linalg.solve(np.swapaxes(sides, 1, 2), (points[off] - origin)[..., None])
        moves = positions[corners[:, 1:]] - positions[corners[:, :1]]
        found[off] = positions[corners[:, 0]] + (part * moves).sum(axis=1)
    return found


def _lifted(points: Array) -> Array:
    return np.column_stack([points, np.zeros(len(points))])
