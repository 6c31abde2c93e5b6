"""Point location: the triangle of each printed point."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from equilibrium.compiled import loop
from fem.elements.tabulation import Floats, Ints

MAX_OUTSIDE = 0.3  # heights of a triangle: points farther outside the mesh are refused
MIN_DEPTH = 1e-6  # heights of a triangle: a point deeper inside is in this triangle only


def triangles_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) triangles of printed points (n, 2).

    A point slightly outside the mesh gets the triangle whose smallest barycentric coordinate there is largest.

    Raises
    ------
    ValueError
        A point is further outside than MAX_OUTSIDE; the message names the first one.
    """
    points = np.asarray(points, dtype=float)
    mapping = mesh.mapping()
    slopes = np.moveaxis(mapping.invA, 2, 0)  # of the two local coordinates of every triangle
    origin = np.einsum("tab,bt->ta", slopes, mapping.b)
    found, depth = np.empty(len(points), dtype=np.int64), np.empty(len(points))
    _search(np.ascontiguousarray(slopes), origin, points, found, depth)
    lost = np.flatnonzero(depth < -MAX_OUTSIDE)
    if len(lost):
        x, y = points[lost[0]]
        raise ValueError(f"point ({x:g}, {y:g}) is outside the sheet")
    return found


@loop
def _search(slopes, origin, points, found, depth):  # type: ignore[no-untyped-def]
    """The triangle that each point lies deepest in, and how deep: the least of its barycentric coordinates.

    scikit-fem's own finder refuses points that rounding has moved over the border.
    """
    last = 0
    for p in range(points.shape[0]):
        x, y = points[p]
        best, deepest = last, -np.inf
        for number in range(-1, len(slopes)):
            t = last if number < 0 else number  # the next point is mostly in the same triangle
            one = slopes[t, 0, 0] * x + slopes[t, 0, 1] * y - origin[t, 0]
            two = slopes[t, 1, 0] * x + slopes[t, 1, 1] * y - origin[t, 1]
            here = min(one, two, 1.0 - one - two)
            if here > deepest:
                best, deepest = t, here
            if here > MIN_DEPTH:
                break
        found[p], depth[p] = best, deepest
        last = best
