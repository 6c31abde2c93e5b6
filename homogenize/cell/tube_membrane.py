"""Membrane stiffness of a tube: how the rolled sheet answers to small strains of its mean surface.

On a flat sheet long thin stars are flat too, buckle to either side at the slightest push, and say little about the
sheet as it is used. On its natural tube they are bumped up. There the mean radius is given (hoop strain), and the axial
shifts are (axial strain and shear); everything else is in equilibrium:

    A = (L H^-1 L^T)^-1 / |cell|,

with H the Hessian of the tube and L the derivative of the strains `E = (a - a_r)/2` of the mean surface, in the axes
(along the tube, around it) and then turned to the print's. A change of radius at the tube's angle also changes its
curvature; the bending energy of that, `D k^2` beside A, is part of the answer and small.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu

from discrete.energies.elements import Array
from homogenize.cell.rolling import Tube
from homogenize.cell.unit_cell import UnitCell


def tube_membrane_stiffness(cell: UnitCell, tube: Tube) -> Array:
    """(3, 3) N/mm, Voigt (E11, E22, 2 E12) in print coordinates, per printed area."""
    cell.tube(tube.curvature, tube.angle)
    whole = cell.pattern.full(cell.hessian(tube.state, 0.0))
    strains = _strain_rates(cell, tube)[:, cell.free]
    flexibility = strains @ splu(whole).solve(np.ascontiguousarray(strains.T))
    along = np.linalg.inv(0.5 * (flexibility + flexibility.T)) / cell.area
    turn = _voigt_turn(cell.turn)
    return np.asarray(turn.T @ along @ turn)


def _strain_rates(cell: UnitCell, tube: Tube) -> Array:
    """(3, dofs) derivative of E11, E22 and 2 E12 of the mean surface, along the tube and around it."""
    n = cell.torus.n_base
    x = tube.state.positions
    rates = np.zeros((3, x.size + len(cell.edges)))
    rows = rates[:, : x.size].reshape(3, *x.shape)
    # axial shifts tau_m = A_m . s, with s = (axial stretch, shear) in the axes of the tube
    slopes = cell.turn @ np.linalg.inv(cell.cell_vectors)
    _, shear = slopes @ x[n:, 0]
    rows[0, n:, 0] = tube.axial * slopes[0]
    # places on the mean surface go along the tube by axial u + shear v, and around it by hoop v
    rows[1, n:, 0] = shear * slopes[1]
    rows[2, n:, 0] = tube.axial * slopes[1] + shear * slopes[0]
    around = x[:n, 1:] / np.linalg.norm(x[:n, 1:], axis=1, keepdims=True)
    rows[1, :n, 1:] = abs(tube.curvature) * tube.hoop * cell.weights[:, None] * around
    return rates


def _voigt_turn(turn: Array) -> Array:
    """(3, 3) Voigt strains in the tube's axes of those in the print's."""
    (a, b), (c, d) = turn
    return np.array([[a * a, b * b, a * b], [c * c, d * d, c * d], [2 * a * c, 2 * b * d, a * d + b * c]])
