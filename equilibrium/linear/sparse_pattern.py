"""The sparsity pattern of a sum of element matrices, computed once, and isostatic supports of its unknowns."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop

SUPPORT_STIFFNESS_FACTOR = 1e3  # stiffness of a support over the largest diagonal entry


class SparsePattern:
    """Lower triangle, by columns (CSC), of a symmetric matrix over the free degrees of freedom (dofs).

    Parameters
    ----------
    element_dofs : one array (E, n) of dof indices for each kind of element.
    n_dofs : number of all dofs.
    free : sorted indices of the free dofs; the matrix has no rows and columns of the others.

    A chain of two springs between three dofs:

    >>> pattern = SparsePattern([np.array([[0, 1], [1, 2]])], 3, np.arange(3))
    >>> data = pattern.assemble([np.array([[1.0, -1.0, 1.0], [1.0, -1.0, 1.0]])])
    >>> pattern.full(data).toarray().tolist()
    [[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]
    """

    def __init__(self, element_dofs: Sequence[Ints], n_dofs: int, free: Ints) -> None:
        self.free = np.asarray(free)
        self.size = len(self.free)  # number of free dofs
        reduced = np.full(n_dofs, -1, dtype=np.int32)
        reduced[self.free] = np.arange(self.size)
        structure = sp.identity(self.size, dtype=bool, format="csc")
        for low, high in _pairs(element_dofs, reduced):
            inside = low >= 0
            pairs = (np.ones(int(inside.sum()), dtype=bool), (high[inside], low[inside]))
            structure = structure + sp.coo_matrix(pairs, shape=structure.shape).tocsc()
        structure.sort_indices()
        # of the lower triangle, sorted; every diagonal entry is present and first in its column
        self.indices, self.indptr = structure.indices.astype(np.int32), structure.indptr.astype(np.int32)
        self.diagonal = self.indptr[:-1]  # (size,) places of the diagonal entries
        # entries with a held dof share one slot at the end, dropped after summing
        slots = [np.empty(0, dtype=np.int32)]
        for low, high in _pairs(element_dofs, reduced):
            slots.append(np.empty(len(low), dtype=np.int32))
            _search_slots(low, high, self.indptr, self.indices, slots[-1])
        self._slots = np.concatenate(slots)

    @classmethod
    def from_lower(cls, low: sp.csc_matrix) -> SparsePattern:
        """Pattern of a lower triangle whose indices are sorted and whose diagonal is full."""
        size = low.shape[0]
        pattern = cls([], size, np.arange(size))
        pattern.indices, pattern.indptr = low.indices, low.indptr
        pattern.diagonal = pattern.indptr[:-1]
        return pattern

    @property
    def nnz(self) -> int:
        """Number of entries of the lower triangle."""
        return len(self.indices)

    def assemble(self, element_values: Iterable[Floats]) -> Floats:
        """Sum (nnz,) of the packed lower triangles (E, n (n + 1) / 2), row by row, in the order of the constructor.

        The elements of one kind may come in several arrays, so that they need not be in memory all at once.
        """
        data = np.zeros(self.nnz + 1)
        start = 0
        for values in element_values:
            flat = np.ascontiguousarray(values).ravel()
            _scatter(flat, self._slots[start : start + len(flat)], data)
            start += len(flat)
        return data[:-1]

    def lower(self, data: Floats) -> sp.csc_matrix:
        """Lower triangle of the entries (nnz,) as a sparse matrix."""
        return sp.csc_matrix((data, self.indices, self.indptr), shape=(self.size, self.size))

    def full(self, data: Floats) -> sp.csc_matrix:
        """Full symmetric matrix of the entries (nnz,) as a sparse matrix."""
        low = self.lower(data)
        return (low + sp.tril(low, -1).T).tocsc()

    def product(self, data: Floats, x: Floats) -> Floats:
        """Product of the symmetric matrix with x (size,) or (size, k)."""
        return self.multiplier(data)(x)

    def multiplier(self, data: Floats) -> Callable[[Floats], Floats]:
        """The products of one symmetric matrix."""
        low, diagonal = self.lower(data), data[self.diagonal]
        upper = low.T
        return lambda x: np.asarray(low @ x + upper @ x - (diagonal * x.T).T)


def _pairs(element_dofs: Sequence[Ints], reduced: Ints) -> Iterator[tuple[Ints, Ints]]:
    """Columns and rows of all entries in the elements' lower triangles, among the free dofs; -1 if one is held."""
    for dofs in element_dofs:
        i, j = np.tril_indices(dofs.shape[1])
        # entries of a batch while a pattern is built: tens of MB
        step = max((1 << 22) // max(len(i), 1), 1)
        for start in range(0, len(dofs), step):
            number = reduced[dofs[start : start + step]]
            a, b = number[:, i].ravel(), number[:, j].ravel()
            low, high = np.minimum(a, b), np.maximum(a, b)
            high[low < 0] = -1
            yield low, high


@loop
def _search_slots(low, high, indptr, indices, slots):  # type: ignore[no-untyped-def]
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


def independent_dofs(motions: Floats) -> Ints:
    """Rows (k,) of the motions (size, k) in which these differ most; holding these unknowns stops all k motions.

    For the six rigid motions of a body this is a 3-2-1 support. Gram-Schmidt on the rows, the longest row first.

    >>> independent_dofs(np.array([[1.0, 0.0], [1.0, 3.0], [1.0, -1.0]])).tolist()
    [1, 2]
    """
    remainder = np.array(motions.T, order="C")  # short rows of a large array are slow
    chosen = np.empty(len(remainder), dtype=np.int64)
    for k in range(len(chosen)):
        chosen[k] = np.argmax(np.einsum("km,km->m", remainder, remainder))
        direction = remainder[:, chosen[k]] / np.linalg.norm(remainder[:, chosen[k]])
        along = direction @ remainder
        for row, part in zip(remainder, direction, strict=True):
            row -= part * along
    return chosen


def stiffen(pattern: SparsePattern, data: Floats, support: Ints) -> None:
    """Add the stiffness of a support at the unknowns `support` (k,) to the entries `data` (nnz,), in place."""
    diagonal = pattern.diagonal
    data[diagonal[support]] += SUPPORT_STIFFNESS_FACTOR * data[diagonal].max()
