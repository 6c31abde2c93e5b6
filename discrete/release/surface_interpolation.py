"""Interpolation of a sheet between the vertices of its mesh."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator, NearestNDInterpolator
from scipy.spatial import ConvexHull

from asterism.equilibrium.arrays import Array, Ints
from asterism.pattern.geometry.planar import distance_to_segment, triangle_areas

MAX_MISSING_HULL_FRACTION = 1e-6  # 1: area of the convex hull outside a sheet that counts as convex, over the hull


def interpolate_surface(printed: Array, triangles: Ints, positions: Array, points: Array, smooth: bool) -> Array:
    """Position of printed points on a sheet that is given at the vertices of its mesh.

    Parameters
    ----------
    printed : (V, 2) mm, printed coordinates of the vertices.
    triangles : (T, 3) vertices.
    positions : (V, 3) mm, positions of the vertices.
    points : (n, 2) mm, printed points.
    smooth : C1 cubics (Clough and Tocher) with gradients of least bending; otherwise linear on triangles.

    Returns
    -------
    (n, 3) mm. Beyond the border the nearest vertex or triangle continues.

    Notes
    -----
    The interpolators of scipy triangulate the points anew and would interpolate across a notch. Sheets that are not
    convex use those of matplotlib, on the triangles of the sheet.

    Examples
    --------
    >>> square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    >>> tilted = np.column_stack([square, square[:, 0]])
    >>> interpolate_surface(square, np.array([[0, 1, 2], [0, 2, 3]]), tilted, np.array([[0.5, 0.2]]), False).round(6)
    array([[0.5, 0.2, 0.5]])
    """
    area = np.abs(triangle_areas(printed, triangles)).sum()
    if area > (1.0 - MAX_MISSING_HULL_FRACTION) * ConvexHull(printed).volume:
        interpolator = CloughTocher2DInterpolator if smooth else LinearNDInterpolator
        out = interpolator(printed, positions, rescale=True)(points)
        outside = np.isnan(out).any(axis=1)
        if outside.any():  # they get the displacement of the nearest vertex
            nearest = NearestNDInterpolator(printed, positions - _in_space(printed))
            out[outside] = nearest(points[outside]) + _in_space(points[outside])
        return np.asarray(out)
    return _on_triangles(printed, triangles, positions, points, smooth)


def _on_triangles(printed: Array, triangles: Ints, positions: Array, points: Array, smooth: bool) -> Array:
    from matplotlib.tri import CubicTriInterpolator, LinearTriInterpolator, Triangulation  # slow to load

    mesh = Triangulation(printed[:, 0], printed[:, 1], triangles)
    finder = mesh.get_trifinder()
    out = np.empty((len(points), 3))
    for axis, values in enumerate(positions.T):
        within = (CubicTriInterpolator if smooth else LinearTriInterpolator)(mesh, values, trifinder=finder)
        out[:, axis] = np.ma.filled(within(*points.T), np.nan)
    outside = np.flatnonzero(np.isnan(out).any(axis=1))
    if len(outside):  # the nearest border triangle continues linearly
        triangle, side = np.nonzero(mesh.neighbors == -1)
        ends = [printed[triangles[triangle, (side + k) % 3]] for k in (0, 1)]
        corners = triangles[triangle[distance_to_segment(points[outside, None], *ends).argmin(axis=1)]]
        origin, sides = printed[corners[:, 0]], printed[corners[:, 1:]] - printed[corners[:, :1]]
        part = np.linalg.solve(np.swapaxes(sides, 1, 2), (points[outside] - origin)[..., None])
        edges = positions[corners[:, 1:]] - positions[corners[:, :1]]
        out[outside] = positions[corners[:, 0]] + (part * edges).sum(axis=1)
    return out


def _in_space(points: Array) -> Array:
    return np.column_stack([points, np.zeros(len(points))])
