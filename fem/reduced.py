"""Matrices over the free unknowns: `T' H T` in a pattern of its own, by one sparse product for every new H."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from equilibrium.sparse_pattern import SparsePattern
from fem.tabulation import Floats, Ints


class Reduced:
    """Restricts symmetric matrices in a pattern to the columns of a map.

    Parameters
    ----------
    pattern : of the matrices, size n.
    columns : (n, k) map T from the free unknowns.

    Attributes
    ----------
    pattern : of the restricted matrices, size k.
    """

    def __init__(self, pattern: SparsePattern, columns: sp.csr_matrix) -> None:
        self._map: sp.csr_matrix | None = None
        self.pattern = pattern
        size = columns.shape[1]
        if size == columns.shape[0] and (columns != sp.identity(size, format="csr")).nnz == 0:
            return
        row, column = pattern.indices, np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        i, j, source, weight = _expanded(columns, row, column)
        # off the diagonal an entry stands for two of the symmetric matrix, of which one is in the lower triangle
        off, both = i != j, (row != column)[source]
        weight[both & ~off] *= 2.0
        weight[off & ~both] *= 0.5
        diagonal = np.arange(size, dtype=np.int64) * (size + 1)
        keys = np.concatenate([diagonal, np.minimum(i, j) * size + np.maximum(i, j)])
        keys, number = np.unique(keys, return_inverse=True)
        lower = sp.csc_matrix(
            (
                np.ones(len(keys)),
                (keys % size).astype(np.int32),
                np.searchsorted(keys, np.arange(size + 1, dtype=np.int64) * size).astype(np.int32),
            ),
            shape=(size, size),
        )
        self.pattern = SparsePattern.of_lower(lower)
        self._map = sp.csr_matrix((weight, (number[size:], source)), shape=(len(keys), pattern.nnz))

    def __call__(self, data: Floats) -> Floats:
        """(nnz of the restricted pattern,) from the entries (nnz,) of a matrix."""
        return data if self._map is None else self._map @ data


def _expanded(columns: sp.csr_matrix, row: Ints, column: Ints) -> tuple[Ints, Ints, Ints, Floats]:
    """All products `T_ri T_cj` of entries (r, c): i, j, the entry's number, and the product."""
    count = np.diff(columns.indptr)
    second = count[column]
    total = count[row] * second
    entry = np.repeat(np.arange(len(row)), total)
    within = np.arange(len(entry)) - np.repeat(np.cumsum(total) - total, total)
    one, two = np.divmod(within, second[entry])
    one += columns.indptr[row[entry]]
    two += columns.indptr[column[entry]]
    i, j = columns.indices[one].astype(np.int64), columns.indices[two].astype(np.int64)
    return i, j, entry, columns.data[one] * columns.data[two]
