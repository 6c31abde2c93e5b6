"""Which unknowns to hold to stop the motions that nothing else stops."""

from __future__ import annotations

import numpy as np

from equilibrium.linear.sparse_pattern import Floats, Ints, SparsePattern

STOP = 1e3  # stiffness of a support over the largest diagonal entry


def independent_dofs(motions: Floats) -> Ints:
    """(k,) rows of motions (free, k) in which they differ the most: holding these stops all of them (3-2-1)."""
    left = motions.copy()
    chosen = np.empty(motions.shape[1], dtype=np.int64)
    for k in range(len(chosen)):  # Gram-Schmidt on the rows, the longest first
        chosen[k] = np.argmax((left**2).sum(axis=1))
        along = left[chosen[k]] / np.linalg.norm(left[chosen[k]])
        left -= np.outer(left @ along, along)
    return chosen


def stiffen(pattern: SparsePattern, data: Floats, support: Ints) -> None:
    """Hold the unknowns of an isostatic support in the matrix with these entries (nnz,), which are changed."""
    diagonal = pattern.diagonal
    data[diagonal[support]] += STOP * data[diagonal].max()
