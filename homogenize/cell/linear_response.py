"""The linear response of a cell in equilibrium: its membrane stiffness.

It is the response of the sheet to small strains of its mean surface. These are given, and all other variables are in
equilibrium:

    A = (L H^-1 L^T)^-1 / |cell|,

with the Hessian H of the cell and the derivative L of the strains. On a flat cell the images of the cell vectors give
the strains. On a flat sheet, long thin stars are flat too and buckle to either side under the smallest load, so the
flat stiffness says little about the sheet in use. On the natural tube the stars are bumped up. There the mean radius
(hoop strain) and the axial shifts (axial strain and shear) give the strains, in the axes of the tube (along, around),
then in those of the print. A change of the radius at constant tube angle also changes the curvature. The bending energy
of that, `D k^2` beside A, is part of the result and small.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.flat_cell import FlatCell
from asterism.homogenize.cell.rolling import Tube
from asterism.homogenize.cell.unit_cell import UnitCell

# 1: added to the diagonal over its largest entry. A straight line in a flat sheet turns about itself without energy.
NEUTRAL_SHIFT = 1e-12


def flat_membrane_stiffness(cell: UnitCell, flat: FlatCell) -> Array:
    """(3, 3) N/mm, Voigt (E11, E22, 2 E12) in print coordinates, per printed area."""
    cell.set_flat()
    n, inverse = cell.mesh.n_base, np.linalg.inv(cell.cell_vectors)
    slope = inverse @ flat.state.positions[n:]  # (2, 3) F^T, of E = (F^T F - 1)/2
    rates = np.zeros((3, cell.n_dofs))
    images = rates[:, 3 * n : 3 * (n + 2)].reshape(3, 2, 3)
    for row, (i, j) in zip(images, ((0, 0), (1, 1), (0, 1)), strict=True):
        row += 0.5 * (1.0 + (i != j)) * (np.outer(inverse[j], slope[i]) + np.outer(inverse[i], slope[j]))
    return _stiffness(cell, flat.state, rates)


def tube_membrane_stiffness(cell: UnitCell, tube: Tube) -> Array:
    """(3, 3) N/mm, Voigt (E11, E22, 2 E12) in print coordinates, per printed area."""
    cell.set_tube(tube.curvature, tube.angle)
    along = _stiffness(cell, tube.state, _strain_rates(cell, tube))
    turn = voigt_turn(cell.turn)
    return np.asarray(turn.T @ along @ turn)


def _stiffness(cell: UnitCell, state: State, rates: Array) -> Array:
    """(3, 3) N/mm, of strains with the derivatives (3, dofs)."""
    whole = cell.pattern.full(cell.hessian(state, 0.0))
    kept = np.setdiff1d(np.arange(len(cell.free)), cell.support(state))  # rotations strain nothing
    whole, strains = whole[kept][:, kept], rates[:, cell.free[kept]]
    if cell.curvature is None and cell.images.n_joints:
        whole = whole + NEUTRAL_SHIFT * float(np.abs(whole.diagonal()).max()) * sp.identity(len(kept))
    flexibility = strains @ splu(whole.tocsc()).solve(np.ascontiguousarray(strains.T))
    return np.asarray(np.linalg.inv(0.5 * (flexibility + flexibility.T)) / cell.area)


def _strain_rates(cell: UnitCell, tube: Tube) -> Array:
    """(3, dofs) derivative of E11, E22 and 2 E12 of the mean surface, along the tube and around it."""
    n = cell.mesh.n_base
    x = tube.state.positions
    rates = np.zeros((3, cell.n_dofs))  # twists of rods and turns of joints leave the mean surface as it is
    rows = rates[:, : x.size].reshape(3, *x.shape)
    # axial shifts tau_m = A_m . s, with s = (axial stretch, shear) in the axes of the tube
    slopes = cell.turn @ np.linalg.inv(cell.cell_vectors)
    _, shear = slopes @ x[n:, 0]
    rows[0, n:, 0] = tube.axial * slopes[0]
    # points of the mean surface move along the tube by axial u + shear v, and around it by hoop v
    rows[1, n:, 0] = shear * slopes[1]
    rows[2, n:, 0] = tube.axial * slopes[1] + shear * slopes[0]
    around = x[:n, 1:] / np.linalg.norm(x[:n, 1:], axis=1, keepdims=True)
    rows[1, :n, 1:] = abs(tube.curvature) * tube.hoop * cell.weights[:, None] * around
    return rates


def voigt_turn(turn: Array) -> Array:
    """(3, 3) T, from Voigt strains in the print's axes to those in turned axes.

    A stiffness C in the turned axes is `T^T C T` in those of the print.
    """
    (a, b), (c, d) = turn
    return np.array([[a * a, b * b, a * b], [c * c, d * d, c * d], [2 * a * c, 2 * b * d, a * d + b * c]])
