"""The fixed sparsity pattern of a sum of element matrices, computed once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from equilibrium.compiled import HAVE_NUMBA, loop

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


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
        reduced = np.full(n_dofs, -1, dtype=np.int64)
        reduced[self.free] = np.arange(self.size)
        keys = [self._keys(reduced[dofs]) for dofs in element_dofs]
        diagonal = np.arange(self.size) * (self.size + 1)
        outside = self.size * self.size  # the slot of entries with a fixed dof, dropped after summing
        unique, slots = np.unique(np.concatenate([*keys, diagonal, [outside]]), return_inverse=True)
        self._slots = slots[: -self.size - 1].astype(np.int32)
        unique = unique[:-1]
        self.indices = (unique % self.size).astype(np.int32)
        self.indptr = np.searchsorted(unique, np.arange(self.size + 1) * self.size).astype(np.int32)
        self.diagonal = self.indptr[:-1]

    def _keys(self, dofs: Ints) -> Ints:
        i, j = np.tril_indices(dofs.shape[1])
        a, b = dofs[:, i], dofs[:, j]
        key = np.minimum(a, b) * self.size + np.maximum(a, b)
        key[(a < 0) | (b < 0)] = self.size**2
        return key.ravel()

    @property
    def nnz(self) -> int:
        """Entries of the lower triangle."""
        return len(self.indices)

    def assemble(self, element_values: Sequence[Floats]) -> Floats:
        """(nnz,) sum of the packed lower triangles (E, n (n + 1) / 2), in the order of the constructor."""
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

    def product(self, data: Floats, x: Floats) -> Floats:
        """Symmetric matrix times x (size,) or (size, k)."""
        low = self.lower(data)
        diagonal = data[self.diagonal]
        return low @ x + low.T @ x - (diagonal * x.T).T


@loop
def _scatter(values, slots, data):  # type: ignore[no-untyped-def]
    for i in range(values.size):
        data[slots[i]] += values[i]
