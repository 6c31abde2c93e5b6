"""A surface without the relief of its stars: the mean over one cell of the lattice around every point."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack
from scipy.spatial import cKDTree

from pattern.geometry.arrays import Floats, Ints

CELL_RIM_TOLERANCE = 1e-6  # of the spacing: on the rim of a cell
AT_ONCE = 2000  # points whose neighbourhoods are looked up together


class CellMean:
    """Means over the cells around the vertices of a mesh, as a matrix.

    A relief that repeats from star to star is removed. Near the outline the cell is cut: both shapes of a comparison
    lose the same part of it.

    Parameters
    ----------
    points : (V, 2) mm, vertices of the printed mesh.
    weights : (V,) mm^2, the part of the sheet that each stands for.
    lattice_vectors : (2, 2) mm, rows.
    at : (k,) the vertices whose means are asked for; all by default.
    """

    def __init__(self, points: Floats, weights: Floats, lattice_vectors: Floats, at: Ints | None = None) -> None:
        span = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)])
        steps = span @ lattice_vectors
        # no point of the plane is further from the lattice than half the diagonal of a rectangle of these sides
        reach = 0.5 * float(np.linalg.norm(lattice_vectors))
        near = CELL_RIM_TOLERANCE * reach**2
        reach *= 1.0 + CELL_RIM_TOLERANCE
        tree = cKDTree(points)
        rows = []
        middles = points if at is None else points[at]
        for begin in range(0, len(middles), AT_ONCE):
            some = middles[begin : begin + AT_ONCE]
            pairs = cKDTree(some).sparse_distance_matrix(tree, reach, output_type="ndarray")
            i, j = pairs["i"], pairs["j"]
            gap = points[j] - some[i]
            square = (gap**2).sum(axis=1)
            shares = np.ones(len(gap))
            inside = np.ones(len(gap), dtype=bool)
            for step in steps:
                other = ((gap - step) ** 2).sum(axis=1)
                inside &= square <= other + near
                # what lies between two cells belongs to both in equal parts
                shares += np.abs(square - other) <= near
            i, j, part = i[inside], j[inside], (weights[j] / shares)[inside]
            rows.append(coo_array((part, (i, j)), shape=(len(some), len(points))).tocsr())
        matrix = csr_array(vstack(rows))
        matrix.data /= np.repeat(matrix.sum(axis=1), np.diff(matrix.indptr))
        self._matrix = matrix

    def __call__(self, values: Floats) -> Floats:
        """(k, m) means of values (V, m)."""
        return np.asarray(self._matrix @ values)
