"""The surface of a sheet without the bumps of its stars: the mean over one lattice cell around each point."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack
from scipy.spatial import cKDTree

from equilibrium.arrays import Floats, Ints

# a point this near to the border of a cell, relative to the spacing, counts as on the border
CELL_BORDER_TOLERANCE = 1e-6
# points whose neighbourhoods are searched in one piece; limits the memory
MEANS_PER_PIECE = 2000


class CellMean:
    """Means over the lattice cells around the vertices of a mesh, as a sparse matrix.

    The mean removes bumps that repeat from star to star. The outline cuts the cells near it, for both shapes of a
    comparison in the same way.

    Parameters
    ----------
    points : (V, 2) mm, vertices of the printed mesh.
    weights : (V,) mm^2, printed area of each vertex; any other unit gives the same means.
    lattice_vectors : (2, 2) mm, rows.
    at : (k,) vertices whose means are computed; all by default.
    """

    def __init__(self, points: Floats, weights: Floats, lattice_vectors: Floats, at: Ints | None = None) -> None:
        span = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)])
        steps = span @ lattice_vectors
        # each point of the plane is within half the diagonal of a rectangle of these sides from a lattice point
        reach = 0.5 * float(np.linalg.norm(lattice_vectors))
        near = CELL_BORDER_TOLERANCE * reach**2
        reach *= 1.0 + CELL_BORDER_TOLERANCE
        tree = cKDTree(points)
        rows = []
        middles = points if at is None else points[at]
        for begin in range(0, len(middles), MEANS_PER_PIECE):
            some = middles[begin : begin + MEANS_PER_PIECE]
            pairs = cKDTree(some).sparse_distance_matrix(tree, reach, output_type="ndarray")
            i, j = pairs["i"], pairs["j"]
            gap = points[j] - some[i]
            square = (gap**2).sum(axis=1)
            shares = np.ones(len(gap))
            inside = np.ones(len(gap), dtype=bool)
            for step in steps:
                other = ((gap - step) ** 2).sum(axis=1)
                inside &= square <= other + near
                # a point on the border between two cells counts by half in each
                shares += np.abs(square - other) <= near
            i, j, part = i[inside], j[inside], (weights[j] / shares)[inside]
            rows.append(coo_array((part, (i, j)), shape=(len(some), len(points))).tocsr())
        matrix = csr_array(vstack(rows))
        matrix.data /= np.repeat(matrix.sum(axis=1), np.diff(matrix.indptr))
        self._matrix = matrix

    def __call__(self, values: Floats) -> Floats:
        """(k, m) means of values (V, m) at the vertices."""
        return np.asarray(self._matrix @ values)
