"""CHOLMOD through scikit-sparse, as an `equilibrium.linear.factor.Factor`."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.sparse_pattern import SparsePattern


class CholmodFactor:
    """Supernodal Cholesky factorisation; scikit-sparse is GPL software and no dependency, users install it.

    Parameters
    ----------
    pattern : sparsity pattern of the matrices, analysed at once.
    """

    name = "cholmod"

    def __init__(self, pattern: SparsePattern) -> None:
        from sksparse.cholmod import analyze

        self._pattern = pattern
        structure = pattern.lower(np.ones(pattern.nnz))
        structure.data[pattern.diagonal] = pattern.size
        self._factor = analyze(structure, mode="supernodal")

    def factorise(self, data: Floats) -> bool:
        """As in `Factor`."""
        from sksparse.cholmod import CholmodNotPositiveDefiniteError

        if not np.isfinite(data).all():
            return False
        try:
            self._factor.cholesky_inplace(self._pattern.lower(data))
        except CholmodNotPositiveDefiniteError:
            return False
        return True

    def solve(self, b: Floats) -> Floats:
        """As in `Factor`."""
        return np.asarray(self._factor(b))

    def close(self) -> None:
        """As in `Factor`."""
        self._factor = None
