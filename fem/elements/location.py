"""Point location: the triangle in which each printed point lies."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop

MAX_OUTSIDE = 0.3  # heights of a triangle, largest distance of a point outside the mesh
MIN_DEPTH = 1e-6  # heights of a triangle, depth from which on a point is in this triangle only


def triangles_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) triangles of printed points (n, 2).

    A point slightly outside the mesh gets the triangle in which its smallest barycentric coordinate is largest.

    Raises
    ------
    ValueError
        A point is further outside than MAX_OUTSIDE; the message names the first one.

    Examples
    --------
    >>> triangles_at(MeshTri(), np.array([[0.1, 0.2], [0.9, 0.7], [1.05, 0.9]])).tolist()
    [0, 1, 1]
    """
    points = np.asarray(points, dtype=float)
    mapping = mesh.mapping()
    slopes = np.moveaxis(mapping.invA, 2, 0)  # gradients of the two reference coordinates of every triangle
    origin = np.einsum("tab,bt->ta", slopes, mapping.b)
    triangles, depth = np.empty(len(points), dtype=np.int64), np.empty(len(points))
    _search(np.ascontiguousarray(slopes), origin, points, triangles, depth)
    outside = np.flatnonzero(depth < -MAX_OUTSIDE)
    if len(outside):
        x, y = points[outside[0]]
        raise ValueError(f"point ({x:g}, {y:g}) is outside the sheet")
    return triangles


@loop
def _search(slopes, origin, points, triangles, depth):  # type: ignore[no-untyped-def]
    """Write the triangle in which each point lies deepest, and its depth: the smallest barycentric coordinate there.

    The finder of scikit-fem refuses points that rounding has moved over the border.
    """
    last = 0
    for p in range(points.shape[0]):
        x, y = points[p]
        best, deepest = last, -np.inf
        for number in range(-1, len(slopes)):
            t = last if number < 0 else number  # the next point is often in the same triangle
            u = slopes[t, 0, 0] * x + slopes[t, 0, 1] * y - origin[t, 0]
            v = slopes[t, 1, 0] * x + slopes[t, 1, 1] * y - origin[t, 1]
            smallest = min(u, v, 1.0 - u - v)
            if smallest > deepest:
                best, deepest = t, smallest
            if smallest > MIN_DEPTH:
                break
        triangles[p], depth[p] = best, deepest
        last = best
