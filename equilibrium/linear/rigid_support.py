"""Isostatic supports: which unknowns to hold so that rigid motions stop and no forces arise."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.linear.sparse_pattern import SparsePattern

SUPPORT_STIFFNESS_FACTOR = 1e3  # stiffness of a support over the largest diagonal entry


def independent_dofs(motions: Floats) -> Ints:
    """Rows (k,) of the motions (size, k) in which these differ most; holding these unknowns stops all k motions.

    For the six rigid motions of a body this is a 3-2-1 support. Gram-Schmidt on the rows, the longest row first.

    >>> independent_dofs(np.array([[1.0, 0.0], [1.0, 3.0], [1.0, -1.0]])).tolist()
    [1, 2]
    """
    remainder = np.array(motions.T, order="C")  # short rows of a large array are slow
    chosen = np.empty(len(remainder), dtype=np.int64)
    for k in range(len(chosen)):
        chosen[k] = np.argmax(np.einsum("km,km->m", remainder, remainder))
        direction = remainder[:, chosen[k]] / np.linalg.norm(remainder[:, chosen[k]])
        along = direction @ remainder
        for row, part in zip(remainder, direction, strict=True):
            row -= part * along
    return chosen


def stiffen(pattern: SparsePattern, data: Floats, support: Ints) -> None:
    """Add the stiffness of a support at the unknowns `support` (k,) to the entries `data` (nnz,), in place."""
    diagonal = pattern.diagonal
    data[diagonal[support]] += SUPPORT_STIFFNESS_FACTOR * data[diagonal].max()
