"""A sparsity pattern with entries beyond a fixed one, for contact forces that come and go."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


class ExtendedPattern(SparsePattern):
    """A fixed pattern and further entries. The base pattern assembles, and its entries are copied into place.

    Parameters
    ----------
    base : the fixed pattern.
    extra : (K,) keys of the further entries of the lower triangle, see `entry_keys`.
    """

    def __init__(self, base: SparsePattern, extra: Ints) -> None:
        self._base = base
        self.free, self.size = base.free, base.size
        column = np.repeat(np.arange(base.size, dtype=np.int64), np.diff(base.indptr))
        fixed = column * base.size + base.indices
        self._keys = sorted_union(fixed, extra)
        self._places = np.searchsorted(self._keys, fixed)
        self.indices = (self._keys % self.size).astype(np.int32)
        self.indptr = np.searchsorted(self._keys, np.arange(self.size + 1) * self.size).astype(np.int32)
        self.diagonal = self.indptr[:-1]

    def contains(self, keys: Ints) -> bool:
        """The pattern has an entry for each of the keys (K,)."""
        places = np.minimum(np.searchsorted(self._keys, keys), self.nnz - 1)
        return bool((self._keys[places] == keys).all())

    def assemble(self, element_values: Iterable[Floats]) -> Floats:
        """Sum (nnz,) of the element matrices of the base pattern; further entries are zero."""
        data = np.zeros(self.nnz)
        data[self._places] = self._base.assemble(element_values)
        return data

    def add(self, data: Floats, keys: Ints, values: Floats) -> None:
        """Add values (K,) at unique keys (K,) to `data` (nnz,), in place."""
        data[np.searchsorted(self._keys, keys)] += values


def sorted_union(first: Ints, second: Ints) -> Ints:
    """Numbers (K,) in either of two arrays, sorted and unique; faster than `np.union1d`, which hashes.

    >>> sorted_union(np.array([5, 1]), np.array([1, 3])).tolist()
    [1, 3, 5]
    """
    both = np.sort(np.concatenate([first, second]), kind="stable")
    return np.asarray(both[np.diff(both, prepend=both[:1] - 1) > 0])


def entry_keys(rows: Ints, columns: Ints, size: int) -> Ints:
    """One number (K,) for each matrix entry, in column-major order (CSC)."""
    return columns.astype(np.int64) * size + rows
