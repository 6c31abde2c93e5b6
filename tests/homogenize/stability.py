"""Stability of a cell on itself and on a supercell of 2 x 2 cells.

A displacement of the supercell is a sum of four kinds (Bloch waves): those that repeat from cell to cell, and those
that change their sign along A1, along A2 or along both. The Hessian does not couple them. So the spectrum of the
supercell is that of four matrices of the size of one cell.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.equilibrium.linear.backends import make_factor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.equilibrium.newton.certificate import smallest_eigenvalue
from asterism.homogenize.cell.periodic_mesh import PeriodicImages
from asterism.homogenize.cell.unit_cell import UnitCell

# signs along A1 and A2 of the displacements that do not repeat from cell to cell
SIGN_CHANGES = ((-1, 1), (1, -1), (-1, -1))


def unfolded_hessian(cell: UnitCell, state: State) -> sp.csr_matrix:
    """(n, n) N/mm, Hessian by the n = 3 U + R + 3 K dofs of `UnitCell.unfolded_gradient`, both triangles."""
    dofs, size = [part.dofs for part in cell.model.parts.values()], cell.n_unfolded_dofs
    pattern, packed = SparsePattern(dofs, size, np.arange(size)), cell.unfolded(state).packed
    return pattern.full(pattern.assemble(part.hessians(packed) for part in cell.model.parts.values())).tocsr()


def reduction_matrix(images: PeriodicImages, signs: Array, n_twists: int, turned: bool = True) -> sp.csr_matrix:
    """(3 U + R + 3 K, 3 V + R + 3 J) unfolded degrees of freedom from those of the cell.

    Parameters
    ----------
    images : of the points and joints.
    signs : (U,) factors of the images.
    n_twists : R.
    turned : the images turn; otherwise they move as their base points.
    """

    def block(base: Array, factors: Array, turn: Array, n_base: int) -> sp.bsr_matrix:
        blocks = factors[:, None, None] * (turn if turned else np.eye(3))
        rows = np.arange(len(base) + 1)
        return sp.bsr_matrix((blocks, base, rows), shape=(3 * len(base), 3 * n_base))

    parts = [block(images.base, signs, images.turn, images.n_base), sp.identity(n_twists)]
    if images.n_joints:
        parts.append(block(images.joint, signs[images.joint_point], images.joint_turn, images.n_joints))
    return sp.block_diag(parts, format="csr")


@dataclass(frozen=True)
class CellStability:
    """Smallest eigenvalues of the Hessian in (mm, rad) coordinates, N/mm."""

    cell: float  # of displacements that repeat from cell to cell
    supercell: float  # of all displacements of 2 x 2 stars


def cell_stability(cell: UnitCell, state: State) -> CellStability:
    """Smallest eigenvalues at an equilibrium.

    Parameters
    ----------
    state : equilibrium of the cell with its present images (flat or tube).
    """
    factor, modes = cell.factor(), cell.rigid_modes(state)
    own = smallest_eigenvalue(cell.pattern, cell.hessian(state, 0.0), factor, modes)
    lowest = own
    hessian, torus = unfolded_hessian(cell, state), cell.mesh
    for signs in SIGN_CHANGES:
        change = np.prod(np.array(signs) ** np.abs(torus.image), axis=1)
        inner = reduction_matrix(cell.images, change, len(cell.edges))
        low = sp.tril(inner.T @ hessian @ inner, format="csc")
        low.sort_indices()
        pattern = SparsePattern.from_lower(low)
        own_factor = make_factor(pattern)
        try:
            supercell_pair = smallest_eigenvalue(pattern, low.data, own_factor, np.empty((pattern.size, 0)))
        finally:
            own_factor.close()
        lowest = min(lowest, supercell_pair, key=lambda pair: pair.value)
    return CellStability(own.value, lowest.value)
