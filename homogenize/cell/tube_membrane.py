"""Membrane stiffness of a tube: the response of the rolled sheet to small strains of its mean surface.

On a flat sheet, long thin stars are flat too and buckle to either side under the smallest load, so the flat stiffness
says little about the sheet in use. On the natural tube the stars are bumped up. There the mean radius (hoop strain) and
the axial shifts (axial strain and shear) are given, and all other variables are in equilibrium:

    A = (L H^-1 L^T)^-1 / |cell|,

with the Hessian H of the tube and the derivative L of the strains of the mean surface. The axes are those of the tube
(along, around), then those of the print. A change of the radius at constant tube angle also changes the curvature. The
bending energy of that, `D k^2` beside A, is part of the result and small.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu

from asterism.equilibrium.arrays import Array
from asterism.homogenize.cell.rolling import Tube
from asterism.homogenize.cell.unit_cell import UnitCell


def tube_membrane_stiffness(cell: UnitCell, tube: Tube) -> Array:
    """(3, 3) N/mm, Voigt (E11, E22, 2 E12) in print coordinates, per printed area.

    Parameters
    ----------
    tube : an equilibrium of this cell, which takes on its images.
    """
    cell.set_tube(tube.curvature, tube.angle)
    whole = cell.pattern.full(cell.hessian(tube.state, 0.0))
    strains = _strain_rates(cell, tube)[:, cell.free]
    flexibility = strains @ splu(whole).solve(np.ascontiguousarray(strains.T))
    along = np.linalg.inv(0.5 * (flexibility + flexibility.T)) / cell.area
    turn = _voigt_turn(cell.turn)
    return np.asarray(turn.T @ along @ turn)


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


def _voigt_turn(turn: Array) -> Array:
    """(3, 3) Voigt strains in the tube's axes from those in the print's."""
    (a, b), (c, d) = turn
    return np.array([[a * a, b * b, a * b], [c * c, d * d, c * d], [2 * a * c, 2 * b * d, a * d + b * c]])
