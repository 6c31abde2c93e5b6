"""Which triangle a printed point lies in."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from equilibrium.compiled import loop
from fem.elements.tabulation import Floats, Ints

SLACK = 0.3  # of a triangle's height: how far outside the mesh a point may lie, where polynomials are still good
INSIDE = 1e-6  # of a triangle's height: a point so far inside is in no other triangle


def triangles_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) triangles of printed points (n, 2).

    For points just outside of the mesh it is the one whose least barycentric coordinate is the largest.

    Raises
    ------
    ValueError
        A point is further outside than SLACK; the message names the first one.
    """
    points = np.asarray(points, dtype=float)
    mapping = mesh.mapping()
    slopes = np.moveaxis(mapping.invA, 2, 0)  # of the two local coordinates of every triangle
    origin = np.einsum("tab,bt->ta", slopes, mapping.b)
    found, depth = np.empty(len(points), dtype=np.int64), np.empty(len(points))
    _search(np.ascontiguousarray(slopes), origin, points, found, depth)
    lost = np.flatnonzero(depth < -SLACK)
    if len(lost):
        x, y = points[lost[0]]
        raise ValueError(f"point ({x:g}, {y:g}) is outside of the sheet")
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
            if here > INSIDE:
                break
        found[p], depth[p] = best, deepest
        last = best
