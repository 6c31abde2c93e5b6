"""The surface of a sheet without the bumps of its stars: the mean over one lattice cell around each point."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csr_array, vstack
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints

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

    Examples
    --------
    Means along a row of points with a bump at every lattice point; the row's end cuts the last cell:

    >>> row = np.column_stack([np.arange(9.0), np.zeros(9)])
    >>> mean = CellMean(row, np.ones(9), np.diag([2.0, 2.0]))
    >>> bumps = row[:, :1] % 2
    >>> mean(bumps).ravel().round(3).tolist()
    [0.333, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.333]
    >>> mean.serves(row, np.ones(9)), mean.serves(row[:5], np.ones(5))
    (True, False)
    """

    def __init__(self, points: Floats, weights: Floats, lattice_vectors: Floats, at: Ints | None = None) -> None:
        # opposite steps give one pair of parallel borders
        steps = np.array([[1, 0], [0, 1], [1, 1], [1, -1]]) @ lattice_vectors
        lengths = (steps**2).sum(axis=1)
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
            # how much nearer a point is to the middle of its cell than to that of the cell beyond each pair of borders
            nearer = lengths - 2.0 * np.abs((points[j] - some[i]) @ steps.T)
            inside = (nearer >= -near).all(axis=1)
            i, j, nearer = i[inside], j[inside], nearer[inside]
            # a point on the border between two cells counts by half in each
            part = weights[j] / (1.0 + (nearer <= near).sum(axis=1))
            rows.append(coo_array((part, (i, j)), shape=(len(some), len(points))).tocsr())
        matrix = csr_array(vstack(rows))
        matrix.data /= np.repeat(matrix.sum(axis=1), np.diff(matrix.indptr))
        self._matrix = matrix
        self._printed = points, weights

    def serves(self, points: Floats, weights: Floats) -> bool:
        """Whether these are the vertices (V, 2) mm and areas (V,) of the mesh: then the means serve it, too."""
        return all(map(np.array_equal, self._printed, (points, weights)))

    def __call__(self, values: Floats) -> Floats:
        """(k, m) means of values (V, m) at the vertices."""
        return np.asarray(self._matrix @ values)
