"""Which triangle a printed point lies in."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from fem.tabulation import Floats, Ints

SLACK = 0.3  # of a triangle's height: how far outside the mesh a point may lie, where polynomials are still good


def triangles_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) triangles of printed points (n, 2), the nearest one for points just outside of the mesh.

    Raises
    ------
    ValueError
        A point is further outside than SLACK; the message names the first one.
    """
    points = np.asarray(points, dtype=float)
    if len(points) == 0:
        return np.empty(0, dtype=np.int64)
    try:
        return np.asarray(mesh.element_finder()(*points.T))
    except ValueError:  # one of them lies outside
        pass
    every = np.arange(mesh.nelements)
    places = np.broadcast_to(points.T[:, None], (2, len(every), len(points)))
    local = mesh.mapping().invF(places, every)
    depth = np.minimum(np.minimum(local[0], local[1]), 1.0 - local[0] - local[1])
    found = depth.argmax(axis=0)
    lost = np.flatnonzero(depth.max(axis=0) < -SLACK)
    if len(lost):
        raise ValueError(f"point ({points[lost[0], 0]:g}, {points[lost[0], 1]:g}) is outside of the sheet")
    return found
