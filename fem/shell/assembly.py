"""Assembly of vectors and matrices over the dofs from values at the quadrature points.

With the strains e of `fem.shell.koiter` and a stress S, a stiffness A at the quadrature points, it integrates

    forces:  int S : e'(x; v) dA,         tangent:  int [ e'(x; v) : A : e'(x; w) + S : e''(x; v, w) ] dA

over the printed domain. The sparsity pattern is computed once. A matrix over the 3 N components of the position is the
lower triangle, by columns, of 3 x 3 blocks, so only the pattern of the scalar dofs is sorted. The column of component d
of dof J holds `3 - d` entries of the diagonal block, then three entries of each further dof.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.fem.elements.argyris import Tabulation
from asterism.fem.shell import koiter


class Assembly:
    """Strains, forces and tangents of one discretisation.

    Parameters
    ----------
    tabulation : basis functions at the quadrature points.
    size : number N of scalar dofs.
    """

    def __init__(self, tabulation: Tabulation, size: int) -> None:
        self.size = size
        # (T, Q) mm^2 and (T, Q, 2) mm, the quadrature
        self.weights, self.points = tabulation.weights, tabulation.points
        self._values = tabulation.values
        self.dofs: Ints = np.ascontiguousarray(tabulation.dofs, dtype=np.int64)
        both = np.concatenate([tabulation.gradients, tabulation.hessians], axis=3)
        self._table: Floats = np.ascontiguousarray(np.swapaxes(both, 2, 3))
        self._keys, self._starts, self._places = _scalar_pattern(self.dofs, size)
        # sparsity pattern over the 3 N components of the position, dof by dof
        self.pattern = SparsePattern.from_lower(self._blocks())

    def _blocks(self) -> sp.csc_matrix:
        """Lower triangle of ones, with a 3 x 3 block for each scalar entry."""
        n = self.size
        count = np.diff(self._starts)
        indptr = np.zeros(3 * n + 1, dtype=np.int32)
        indptr[1:] = np.cumsum((3 * count[:, None] - np.arange(3)).ravel())
        column = np.repeat(np.arange(n), count)
        place = 3 * (np.arange(len(column)) - self._starts[column])
        indices = np.empty(indptr[-1], dtype=np.int32)
        for c in range(3):  # of a diagonal block, the lower triangle only
            row = 3 * (self._keys - n * column) + c
            for d in range(3):
                kept = slice(None) if d <= c else place > 0
                indices[(indptr[3 * column + d] + place + (c - d))[kept]] = row[kept]
        return sp.csc_matrix((np.ones(len(indices)), indices, indptr), shape=(3 * n, 3 * n))

    def strains(self, x: Floats, rest: Floats) -> Floats:
        """(T, Q, 6) strains of positions x (N, 3); rest values (T, Q, 6) as in `fem.shell.koiter.strains`."""
        out = np.empty_like(rest)
        koiter.strains(self._table, self.dofs, x, rest, out)
        return out

    def strain_changes(self, x: Floats, move: Floats) -> Floats:
        """(T, Q, 6) derivative of the strains at x (N, 3) along a displacement `move` (N, 3)."""
        out = np.empty((*self.weights.shape, 6))
        koiter.strain_changes(self._table, self.dofs, x, move, out)
        return out

    def forces(self, x: Floats, stress: Floats) -> Floats:
        """(N, 3) forces `int S : e'(x)` of a stress (T, Q, 6) at x (N, 3)."""
        out = np.zeros((self.size, 3))
        koiter.forces(self._table, self.dofs, self.weights, x, stress, out)
        return out

    def tangent(self, x: Floats, stiffness: Floats, stress: Floats) -> Floats:
        """(nnz,) entries of `int [B' A B + S : e'']` with `B = e'(x)`, stiffness A (T, Q, 6, 6), stress S (T, Q, 6)."""
        data = np.zeros(self.pattern.nnz)
        koiter.tangent(
            self._table, self.dofs, self.weights, x, stiffness, stress, self._places, self.pattern.indptr, data
        )
        return data

    def product(self, data: Floats, x: Floats) -> Floats:
        """(N, 3) product of the symmetric matrix with entries `data` (nnz,) in the pattern and x (N, 3)."""
        return self.pattern.product(data, x.ravel()).reshape(-1, 3)

    @cached_property
    def mass(self) -> Floats:
        """(nnz,) mm^2, entries of the mass matrix of the basis functions, for each component of the position."""
        values = self._values
        i, j = np.tril_indices(self.dofs.shape[1])
        blocks = np.matmul(np.swapaxes(self.weights[..., None] * values, 1, 2), values)[:, i, j]
        first = np.minimum(self.dofs[:, i], self.dofs[:, j])
        scalar = np.bincount((self._starts[first] + self._places).ravel(), blocks.ravel(), len(self._keys))
        column = self._keys // self.size
        place, data = np.arange(len(column)) - self._starts[column], np.zeros(self.pattern.nnz)
        for d in range(3):
            data[self.pattern.indptr[3 * column + d] + 3 * place] = scalar
        return data


def _scalar_pattern(dofs: Ints, size: int) -> tuple[Ints, Ints, Ints]:
    """Sorted keys `column N + row` of the lower triangle, starts (N + 1,) of its columns, and places of the pairs.

    The place (T, m (m + 1)/2) of a pair of dofs is its position within its column; 0 is the diagonal.
    """
    i, j = np.tril_indices(dofs.shape[1])
    low, high = np.minimum(dofs[:, i], dofs[:, j]), np.maximum(dofs[:, i], dofs[:, j])
    pair_keys = low * size + high
    diagonal = np.arange(size, dtype=np.int64) * (size + 1)  # also of a dof that no triangle uses
    keys, number = np.unique(np.concatenate([diagonal, pair_keys.ravel()]), return_inverse=True)
    starts = np.searchsorted(keys, np.arange(size + 1, dtype=np.int64) * size)
    places = number[size:].reshape(pair_keys.shape) - starts[low]
    return keys, starts, places.astype(np.int32)


class MatrixReduction:
    """Computes `T' H T` for symmetric matrices H in a given pattern.

    Parameters
    ----------
    pattern : sparsity pattern of H, of size n.
    columns : (n, k) the map T from the free unknowns.
    """

    def __init__(self, pattern: SparsePattern, columns: sp.csr_matrix) -> None:
        self._map: sp.csr_matrix | None = None
        self.pattern = pattern  # sparsity pattern of `T' H T`, of size k
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
