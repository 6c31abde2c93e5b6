"""A sparsity pattern with more entries than the fixed one, for forces that come and go."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from equilibrium.linear.sparse_pattern import Floats, Ints, SparsePattern


class ExtendedPattern(SparsePattern):
    """A pattern and further entries; what it assembles is spread from the pattern it extends.

    Parameters
    ----------
    base : the fixed pattern.
    extra : (K,) keys of further entries of the lower triangle, see `entry_keys`.
    """

    def __init__(self, base: SparsePattern, extra: Ints) -> None:
        self._base = base
        self.free, self.size = base.free, base.size
        column = np.repeat(np.arange(base.size, dtype=np.int64), np.diff(base.indptr))
        fixed = column * base.size + base.indices
        self._all = united(fixed, extra)
        self._places = np.searchsorted(self._all, fixed)
        self.indices = (self._all % self.size).astype(np.int32)
        self.indptr = np.searchsorted(self._all, np.arange(self.size + 1) * self.size).astype(np.int32)
        self.diagonal = self.indptr[:-1]

    def holds(self, keys: Ints) -> bool:
        """All these entries are in the pattern."""
        places = np.minimum(np.searchsorted(self._all, keys), self.nnz - 1)
        return bool((self._all[places] == keys).all())

    def assemble(self, element_values: Iterable[Floats]) -> Floats:
        """(nnz,) sum of the element matrices of the fixed pattern."""
        data = np.zeros(self.nnz)
        data[self._places] = self._base.assemble(element_values)
        return data

    def add(self, data: Floats, keys: Ints, values: Floats) -> None:
        """Add values (K,) at unique keys (K,) to `data` (nnz,)."""
        data[np.searchsorted(self._all, keys)] += values


def united(one: Ints, other: Ints) -> Ints:
    """(K,) the numbers in either of two arrays, each once and in order; `np.union1d`, which hashes, takes longer."""
    both = np.sort(np.concatenate([one, other]), kind="stable")
    return np.asarray(both[np.diff(both, prepend=both[:1] - 1) > 0])


def entry_keys(rows: Ints, columns: Ints, size: int) -> Ints:
    """(K,) one number for each entry, in the order of the columns (CSC)."""
    return columns.astype(np.int64) * size + rows
