"""Matrices over the free unknowns, `T' H T`: their entries are a fixed linear map of the entries of H."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.compiled import loop
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


class MatrixReduction:
    """Computes `T' H T` for symmetric matrices H in a given pattern.

    Parameters
    ----------
    pattern : sparsity pattern of H, of size n.
    columns : (n, k) the map T from the free unknowns.

    Attributes
    ----------
    pattern : sparsity pattern of `T' H T`, of size k.
    """

    def __init__(self, pattern: SparsePattern, columns: sp.csr_matrix) -> None:
        self._map: sp.csr_matrix | None = None
        self.pattern = pattern
        size = columns.shape[1]
        if size == columns.shape[0] and (columns != sp.identity(size, format="csr")).nnz == 0:
            return
        column = np.repeat(np.arange(pattern.size), np.diff(pattern.indptr))
        count = np.diff(columns.indptr)
        total = size + int((count[pattern.indices].astype(np.int64) * count[column]).sum())
        # all diagonal entries with value zero, then the products
        keys, source, weight = np.empty(total, dtype=np.int64), np.zeros(total, dtype=np.int32), np.zeros(total)
        keys[:size] = np.arange(size, dtype=np.int64) * (size + 1)
        _products(
            pattern.indices, column, columns.indptr, columns.indices, columns.data,
            size, keys[size:], source[size:], weight[size:],
        )  # fmt: skip
        order = np.argsort(keys, kind="stable")  # fast, since long runs are sorted
        keys = keys[order]
        starts = np.flatnonzero(np.r_[True, keys[1:] != keys[:-1]])
        keys = keys[starts]
        lower = sp.csc_matrix(
            (
                np.ones(len(keys)),
                (keys % size).astype(np.int32),
                np.searchsorted(keys, np.arange(size + 1, dtype=np.int64) * size).astype(np.int32),
            ),
            shape=(size, size),
        )
        self.pattern = SparsePattern.from_lower(lower)
        self._map = sp.csr_matrix((weight[order], source[order], np.r_[starts, total]), shape=(len(keys), pattern.nnz))

    def __call__(self, data: Floats) -> Floats:
        """Entries of `T' H T` in its pattern, from the entries (nnz,) of H."""
        return data if self._map is None else self._map @ data


@loop
def _products(row, column, indptr, indices, values, size, keys, source, weight):  # type: ignore[no-untyped-def]
    """Write all products `T_ri T_cj` of entries (r, c) of a lower triangle: key in `T' H T`, entry number, product.

    An entry off the diagonal stands for two entries of the symmetric matrix.
    """
    k = 0
    for entry in range(row.size):
        r, c = row[entry], column[entry]
        for a in range(indptr[r], indptr[r + 1]):
            for b in range(indptr[c], indptr[c + 1]):
                i, j = indices[a], indices[b]
                product = values[a] * values[b]
                if i == j and r != c:
                    product *= 2.0
                if i != j and r == c:
                    product *= 0.5
                keys[k] = min(i, j) * size + max(i, j)
                source[k], weight[k] = entry, product
                k += 1
