"""The mass of a shell over its free unknowns, by the one of a single component of the position."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fem.elements.tabulation import Floats
from fem.supports.conditions import Reduction


class ReducedMass:
    """`T' (M x I) T`, never made: M is three times smaller both ways.

    Parameters
    ----------
    scalar : (N, N) mm^2, M.
    reduction : its map T (3N, n).
    """

    def __init__(self, scalar: sp.csr_matrix, reduction: Reduction) -> None:
        self._scalar, self._reduction = scalar, reduction

    def __matmul__(self, vectors: Floats) -> Floats:
        """(n, k) from (n, k)."""
        moves = np.asarray(self._reduction.map @ vectors)
        pushes = self._scalar @ moves.reshape(len(moves) // 3, -1)
        return np.asarray(self._reduction.transposed @ pushes.reshape(moves.shape))
