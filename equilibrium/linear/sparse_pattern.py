"""The fixed sparsity pattern of a sum of element matrices, computed once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from equilibrium.compiled import HAVE_NUMBA, loop

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

PIECE = 1 << 22  # entries looked at together while a pattern is made: some tens of MB


class SparsePattern:
    """Lower triangle, by columns (CSC), of a symmetric matrix over the free dofs.

    Parameters
    ----------
    element_dofs : one (E, n) array of dof indices for each kind of element.
    n_dofs : number of all dofs.
    free : sorted indices of the free ones; rows and columns of the others are left out.

    Attributes
    ----------
    size : number of free dofs.
    indptr, indices : of the lower triangle, sorted; every diagonal entry is present and first in its column.
    """

    def __init__(self, element_dofs: Sequence[Ints], n_dofs: int, free: Ints) -> None:
        self.free = np.asarray(free)
        self.size = len(self.free)
        reduced = np.full(n_dofs, -1, dtype=np.int32)
        reduced[self.free] = np.arange(self.size)
        structure = sp.identity(self.size, dtype=bool, format="csc")
        for low, high in _pairs(element_dofs, reduced):
            inside = low >= 0
            pairs = (np.ones(int(inside.sum()), dtype=bool), (high[inside], low[inside]))
            structure = structure + sp.coo_matrix(pairs, shape=structure.shape).tocsc()
        structure.sort_indices()
        self.indices, self.indptr = structure.indices.astype(np.int32), structure.indptr.astype(np.int32)
        self.diagonal = self.indptr[:-1]
        # entries with a held dof have a slot of their own at the end, dropped after summing
        found = [self._slots_at(low, high) for low, high in _pairs(element_dofs, reduced)]
        self._slots = np.concatenate([*found, np.empty(0, dtype=np.int32)])

    @classmethod
    def of_lower(cls, low: sp.csc_matrix) -> SparsePattern:
        """The pattern of a given lower triangle, its indices sorted and its diagonal full."""
        size = low.shape[0]
        pattern = cls([], size, np.arange(size))
        pattern.indices, pattern.indptr = low.indices, low.indptr
        pattern.diagonal = pattern.indptr[:-1]
        return pattern

    def _slots_at(self, low: Ints, high: Ints) -> Ints:
        """Slots of the entries in columns `low` (-1: none) and rows `high`."""
        slots = np.empty(len(low), dtype=np.int32)
        if HAVE_NUMBA:
            _search(low, high, self.indptr, self.indices, slots)
        else:
            column = np.repeat(np.arange(self.size), np.diff(self.indptr))
            slots[:] = np.searchsorted(column * self.size + self.indices, low.astype(np.int64) * self.size + high)
            slots[low < 0] = self.nnz
        return slots

    @property
    def nnz(self) -> int:
        """Entries of the lower triangle."""
        return len(self.indices)

    def assemble(self, element_values: Iterable[Floats]) -> Floats:
        """(nnz,) sum of the packed lower triangles (E, n (n + 1) / 2), in the order of the constructor.

        The elements of a kind may come in several pieces, so that they need not exist all at once.
        """
        data = np.zeros(self.nnz + 1)
        start = 0
        for values in element_values:
            flat = np.ascontiguousarray(values).ravel()
            slots = self._slots[start : start + len(flat)]
            if HAVE_NUMBA:
                _scatter(flat, slots, data)
            else:
                data += np.bincount(slots, weights=flat, minlength=len(data))
            start += len(flat)
        return data[:-1]

    def lower(self, data: Floats) -> sp.csc_matrix:
        """The lower triangle as a sparse matrix."""
        return sp.csc_matrix((data, self.indices, self.indptr), shape=(self.size, self.size))

    def full(self, data: Floats) -> sp.csc_matrix:
        """Both triangles as a sparse matrix."""
        low = self.lower(data)
        return (low + sp.tril(low, -1).T).tocsc()

    def product(self, data: Floats, x: Floats) -> Floats:
        """Symmetric matrix times x (size,) or (size, k)."""
        low = self.lower(data)
        diagonal = data[self.diagonal]
        return low @ x + low.T @ x - (diagonal * x.T).T


def _pairs(element_dofs: Sequence[Ints], reduced: Ints) -> Iterator[tuple[Ints, Ints]]:
    """Columns and rows (free numbers, -1 for both if one is held) of all entries in the elements' lower triangles."""
    for dofs in element_dofs:
        i, j = np.tril_indices(dofs.shape[1])
        step = max(PIECE // max(len(i), 1), 1)
        for start in range(0, len(dofs), step):
            number = reduced[dofs[start : start + step]]
            a, b = number[:, i].ravel(), number[:, j].ravel()
            low, high = np.minimum(a, b), np.maximum(a, b)
            high[low < 0] = -1
            yield low, high


@loop
def _search(low, high, indptr, indices, slots):  # type: ignore[no-untyped-def]
    for k in range(low.size):
        if low[k] < 0:
            slots[k] = indices.size
            continue
        a, b = indptr[low[k]], indptr[low[k] + 1]
        while b - a > 1:
            middle = (a + b) // 2
            if indices[middle] <= high[k]:
                a = middle
            else:
                b = middle
        slots[k] = a


@loop
def _scatter(values, slots, data):  # type: ignore[no-untyped-def]
    for i in range(values.size):
        data[slots[i]] += values[i]
