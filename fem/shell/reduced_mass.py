"""The mass matrix of a shell over its free unknowns, from that of a single component of the position."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.fem.supports.conditions import Reduction


class ReducedMass:
    """The operator `T' (M x I) T`, applied without assembling it.

    Parameters
    ----------
    scalar : (N, N) mm^2, mass matrix M of one component.
    reduction : supports, with the map T (3N, n).
    """

    def __init__(self, scalar: sp.csr_matrix, reduction: Reduction) -> None:
        self._scalar, self._reduction = scalar, reduction

    def __matmul__(self, vectors: Floats) -> Floats:
        """(n, k) product with vectors (n, k)."""
        full = np.asarray(self._reduction.map @ vectors)
        product = self._scalar @ full.reshape(len(full) // 3, -1)
        return np.asarray(self._reduction.transposed @ product.reshape(full.shape))
