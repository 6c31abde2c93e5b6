"""Normals of a triangulated sheet in space, on the plastic side."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from asterism.equilibrium.arrays import Floats


def triangle_normals(
    positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]
) -> Float[np.ndarray, "T 3"]:
    """(T, 3) mm^2, normals towards the plastic side, each as long as twice its triangle's area."""
    x, y, z = positions.T
    a, b, c = triangles.T
    (ux, vx), (uy, vy), (uz, vz) = ((one[b] - one[a], one[c] - one[a]) for one in (x, y, z))
    return np.column_stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx])


def vertex_normals(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> Float[np.ndarray, "V 3"]:
    """(V, 3) unit normals on the plastic side: mean of the triangles around, weighted by area."""
    normals = sum_at_vertices(triangles, np.repeat(triangle_normals(positions, triangles), 3, axis=0), len(positions))
    # where the sheet is folded onto itself, the normal is undefined: use an arbitrary unit vector
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.where(length > 0, normals / np.where(length > 0, length, 1.0), [0.0, 0.0, 1.0])


def sum_at_vertices(
    triangles: Int[np.ndarray, "T 3"], per_corner: Floats, count: int
) -> Float[np.ndarray, "{count} ..."]:
    """Sum over the corners at each vertex of values (3 T,) or (3 T, m) listed triangle by triangle."""
    corners, columns = triangles.ravel(), np.atleast_2d(per_corner.T)
    gathered = np.column_stack([np.bincount(corners, column, count) for column in columns])
    return np.asarray(gathered.reshape(count, *per_corner.shape[1:]), dtype=float)
