"""Which triangle a printed point lies in."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from fem.tabulation import Floats, Ints

SLACK = 0.3  # of a triangle's height: how far outside the mesh a point may lie, where polynomials are still good
PAIRS = 1 << 16  # of points and triangles that are looked at together: they stay in the processor's cache


def triangles_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) triangles of printed points (n, 2), the nearest one for points just outside of the mesh.

    Raises
    ------
    ValueError
        A point is further outside than SLACK; the message names the first one.
    """
    points = np.asarray(points, dtype=float)
    found = np.empty(len(points), dtype=np.int64)
    mapping, size = mesh.mapping(), max(PAIRS // mesh.nelements, 1)
    slopes = np.moveaxis(mapping.invA, 2, 1)  # of the two local coordinates of every triangle
    origin = np.einsum("atb,bt->at", slopes, mapping.b)
    for start in range(0, len(points), size):
        # as scikit-fem's own finder does, which refuses points that rounding has moved over the border
        one, two = slopes @ points[start : start + size].T - origin[..., None]
        depth = 1.0 - one - two
        np.minimum(np.minimum(one, two, out=one), depth, out=depth)
        found[start : start + size] = depth.argmax(axis=0)
        lost = np.flatnonzero(depth.max(axis=0) < -SLACK)
        if len(lost):
            x, y = points[start + lost[0]]
            raise ValueError(f"point ({x:g}, {y:g}) is outside of the sheet")
    return found
