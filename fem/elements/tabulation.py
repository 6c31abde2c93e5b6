"""Values and derivatives of the functions of a space: at quadrature points, and at any printed points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int

from asterism.equilibrium.arrays import Floats, Ints

Functions = Callable[[], tuple[Ints, Floats]]


@dataclass(frozen=True)
class Tabulation:
    """Scalar basis functions of T triangles at Q quadrature points each; lengths are printed mm.

    Attributes
    ----------
    dofs : (T, m) scalar dofs of each triangle's stencil, the same for the three components of the position.
    values : (T, Q, m).
    gradients : (T, Q, m, 2) derivatives 1, 2.
    hessians : (T, Q, m, 3) derivatives 11, 22, 12; a discrete Hessian where the functions are not C1.
    weights : (T, Q) mm^2 of printed area.
    points : (T, Q, 2) mm.
    """

    dofs: Int[np.ndarray, "T m"]
    values: Float[np.ndarray, "T Q m"]
    gradients: Float[np.ndarray, "T Q m 2"]
    hessians: Float[np.ndarray, "T Q m 3"]
    weights: Float[np.ndarray, "T Q"]
    points: Float[np.ndarray, "T Q 2"]


class Evaluation:
    """Evaluation of the functions of a space at n printed points.

    Parameters
    ----------
    functions : returns dofs (n, m) of the points and (n, m, 6) value and derivatives 1, 2, 11, 22, 12 of their
        functions; called at the first use.
    size : number N of scalar dofs.
    jets : maps coefficients (N, k) to (n, 6, k), for spaces that evaluate polynomials faster than by matrices.
    """

    def __init__(self, functions: Functions, size: int, jets: Callable[[Floats], Floats] | None = None) -> None:
        self._functions, self._size, self._jets = functions, size, jets

    def jets(self, x: Floats) -> Floats:
        """(n, 6, k) value and derivatives 1, 2, 11, 22, 12 of functions with coefficients x (N, k)."""
        if self._jets is not None:
            return self._jets(x)
        dofs, table = self._table
        return np.asarray(np.matmul(np.swapaxes(table, 1, 2), x[dofs]))

    def spread(self, forces: Floats) -> Floats:
        """(N, k) forces on the dofs that do the same work as forces (n, k) at the points."""
        dofs, table = self._table
        out = np.zeros((self._size, forces.shape[1]))
        np.add.at(out, dofs, table[..., :1] * forces[:, None])
        return out

    @cached_property
    def _table(self) -> tuple[Ints, Floats]:
        return self._functions()

    @cached_property
    def value(self) -> sp.csr_matrix:
        """(n, N) matrix from dofs to values."""
        return self._matrix(slice(0, 1))

    @cached_property
    def gradient(self) -> sp.csr_matrix:
        """(2n, N) matrix from dofs to derivatives 1, 2; the two of a point follow each other."""
        return self._matrix(slice(1, 3))

    @cached_property
    def hessian(self) -> sp.csr_matrix:
        """(3n, N) matrix from dofs to derivatives 11, 22, 12."""
        return self._matrix(slice(3, 6))

    def _matrix(self, part: slice) -> sp.csr_matrix:
        dofs, jets = self._table
        table = jets[..., part]
        points, entries, parts = table.shape
        ends = entries * np.arange(points * parts + 1)
        columns = np.repeat(dofs[:, None], parts, axis=1)
        shape = (points * parts, self._size)
        return sp.csr_matrix((np.swapaxes(table, 1, 2).ravel(), columns.ravel(), ends), shape=shape)
