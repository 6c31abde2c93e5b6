"""Laplacian and curvatures of a triangulated disk.

With the angles alpha and beta opposite to an edge, its weight is `(cot alpha + cot beta)/2` (Pinkall and Polthier
1993). The matrix A with `(A u)_i = sum_j w_ij (u_i - u_j)` is positive semidefinite: it stands for minus the integral
of the Laplacian over the cell of vertex i.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints


def corner_angles(vertices: Floats, triangles: Ints) -> Floats:
    """(T, 3) rad, angles at the corners of each triangle.

    Examples
    --------
    >>> points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    >>> np.rad2deg(corner_angles(points, np.array([[0, 1, 2]]))).round(6).tolist()
    [[90.0, 45.0, 45.0]]
    """
    corners = vertices[triangles]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = np.linalg.norm(np.cross(ahead, behind), axis=2)
    return np.asarray(np.arctan2(cross, np.einsum("tkc,tkc->tk", ahead, behind)))


def laplacian(angles: Floats, triangles: Ints, count: int) -> sp.csc_array:
    """(V, V) the matrix A above, in no unit.

    Parameters
    ----------
    angles : (T, 3) rad, from `corner_angles`.
    triangles : (T, 3).
    count : V, number of vertices.
    """
    half = 0.5 / np.tan(angles)
    i, j = np.roll(triangles, -1, axis=1).ravel(), np.roll(triangles, 1, axis=1).ravel()
    weights = sp.coo_array((half.ravel(), (i, j)), shape=(count, count))
    weights = weights + weights.T
    return sp.csc_array(sp.diags_array(np.asarray(weights.sum(axis=1)).ravel()) - weights)


def angle_sums(angles: Floats, triangles: Ints, count: int) -> Floats:
    """(V,) rad, sum of the angles around each vertex.

    Inside, 2 pi minus the sum is the integral of the Gauss curvature. On the border, pi minus the sum is the integral
    of the geodesic curvature.
    """
    return np.asarray(np.bincount(triangles.ravel(), angles.ravel(), count))
