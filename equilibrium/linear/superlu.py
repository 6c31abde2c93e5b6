"""SuperLU from scipy, as an `equilibrium.linear.factor.Factor`."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


class SuperLUFactor:
    """SuperLU in its symmetric mode: available everywhere, but slower, and every matrix is ordered anew.

    Without row exchanges the factors are L D L^T, and the signs of D are the inertia of the matrix.

    Parameters
    ----------
    pattern : sparsity pattern of the matrices.
    """

    name = "superlu"

    def __init__(self, pattern: SparsePattern) -> None:
        self._pattern = pattern
        self._lu: Any = None

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`."""
        if not np.isfinite(data).all():
            return False
        full = self._pattern.full(data)
        try:
            lu = splu(full, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        except RuntimeError:  # exactly singular
            return False
        if not np.array_equal(lu.perm_r, lu.perm_c) or lu.U.diagonal().min() <= 0.0:
            return False
        self._lu = lu
        return True

    def solve(self, b: Floats) -> Floats:
        """As in `Factor`."""
        return np.asarray(self._lu.solve(np.asarray(b, dtype=float)))

    def close(self) -> None:
        """As in `Factor`."""
        self._lu = None
