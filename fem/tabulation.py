"""What a discretisation tells everything else: its functions at quadrature points, and at any printed point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]


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

    dofs: Ints
    values: Floats
    gradients: Floats
    hessians: Floats
    weights: Floats
    points: Floats


@dataclass(frozen=True)
class Evaluation:
    """Sparse matrices (n, N) from dofs to values at printed points, and (2n, N), (3n, N) to derivatives there.

    `gradient` and `hessian` have their components 1, 2 and 11, 22, 12 one after the other for each point.
    """

    value: sp.csr_matrix
    gradient: sp.csr_matrix
    hessian: sp.csr_matrix

    @classmethod
    def of(cls, dofs: Ints, jets: Floats, size: int) -> Evaluation:
        """From dofs (n, m) of the points and (n, m, 6) value and derivatives 1, 2, 11, 22, 12."""
        return cls(*(_matrix(dofs, jets[..., part], size) for part in (slice(0, 1), slice(1, 3), slice(3, 6))))


def _matrix(dofs: Ints, table: Floats, size: int) -> sp.csr_matrix:
    points, entries, parts = table.shape
    ends = entries * np.arange(points * parts + 1)
    columns = np.repeat(dofs[:, None], parts, axis=1)
    return sp.csr_matrix((np.swapaxes(table, 1, 2).ravel(), columns.ravel(), ends), shape=(points * parts, size))
