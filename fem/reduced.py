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
        column = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        row = pattern.indices.astype(np.int64)
        entry = np.arange(pattern.nnz)
        off = row != column  # these stand for two entries of the symmetric matrix
        row, column, entry = (
            np.concatenate([row, column[off]]),
            np.concatenate([column, row[off]]),
            np.concatenate([entry, entry[off]]),
        )
        i, j, source, weight = _expanded(columns, row, column, entry)
        low = i >= j
        diagonal = np.arange(size, dtype=np.int64) * (size + 1)
        keys, number = np.unique(np.concatenate([diagonal, j[low] * size + i[low]]), return_inverse=True)
        lower = sp.csc_matrix(
            (
                np.ones(len(keys)),
                (keys % size).astype(np.int32),
                np.searchsorted(keys, np.arange(size + 1, dtype=np.int64) * size).astype(np.int32),
            ),
            shape=(size, size),
        )
        self.pattern = SparsePattern.of_lower(lower)
        self._map = sp.csr_matrix((weight[low], (number[size:], source[low])), shape=(len(keys), pattern.nnz))

    def __call__(self, data: Floats) -> Floats:
        """(nnz of the restricted pattern,) from the entries (nnz,) of a matrix."""
        return data if self._map is None else self._map @ data


def _expanded(columns: sp.csr_matrix, row: Ints, column: Ints, entry: Ints) -> tuple[Ints, Ints, Ints, Floats]:
    """All products `T_ri T_cj` of the entries (r, c): i, j, the entry's number, and the product."""
    count = np.diff(columns.indptr)
    first, second = count[row], count[column]
    total = first * second
    which = np.repeat(np.arange(len(row)), total)
    within = np.arange(total.sum()) - np.repeat(np.cumsum(total) - total, total)
    one = columns.indptr[row[which]] + within // second[which]
    two = columns.indptr[column[which]] + within % second[which]
    i, j = columns.indices[one].astype(np.int64), columns.indices[two].astype(np.int64)
    return i, j, entry[which], columns.data[one] * columns.data[two]
