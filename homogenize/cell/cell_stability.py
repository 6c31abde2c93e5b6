"""Is a cell's equilibrium a minimum, on the cell itself and with its neighbours free to differ from it?

A displacement of the 2 x 2 supercell is a sum of four kinds: those that repeat from cell to cell, and those that change
sign from one cell to the next along A1, along A2 or along both. The Hessian does not mix them, so that the supercell's
spectrum is that of four matrices of one cell's size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from discrete.model.state import State
from equilibrium.linear.backends import make_factor
from equilibrium.linear.sparse_pattern import SparsePattern
from equilibrium.newton.certificate import smallest_eigenvalue
from homogenize.cell.effective_stiffness import reduction_matrix
from homogenize.cell.unit_cell import UnitCell

SIGN_CHANGES = ((-1, 1), (1, -1), (-1, -1))


@dataclass(frozen=True)
class CellStability:
    """Smallest eigenvalues, N/mm in (mm, rad) coordinates, with the norms of their residuals."""

    cell: float
    cell_error: float
    supercell: float
    supercell_error: float


def cell_stability(cell: UnitCell, state: State) -> CellStability:
    """Of an equilibrium of the cell with the images that it has now."""
    factor, modes = cell.factor(), cell.rigid_modes(state)
    own = smallest_eigenvalue(cell.pattern, cell.hessian(state, 0.0), factor, modes)
    lowest = own
    hessian, torus = cell.unfolded_hessian(state), cell.torus
    for signs in SIGN_CHANGES:
        change = np.prod(np.array(signs) ** np.abs(torus.image), axis=1)
        inner = reduction_matrix(torus.base, change, cell.images.turn, torus.n_base, len(cell.edges))
        low = sp.tril(inner.T @ hessian @ inner, format="csc")
        low.sort_indices()
        pattern = SparsePattern.from_lower(low)
        own_factor = make_factor(pattern)
        try:
            found = smallest_eigenvalue(pattern, low.data, own_factor, np.empty((pattern.size, 0)))
        finally:
            own_factor.close()
        lowest = min(lowest, found, key=lambda pair: pair.value)
    return CellStability(own.value, own.error, lowest.value, lowest.error)
