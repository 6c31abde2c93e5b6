"""Stiffness of the flat relaxed cell: the energy's second derivative with everything else in equilibrium.

`A = (H_ee - H_eq H_qq^-1 H_qe)/|cell|`, where e is what is imposed and q is all else (static condensation).
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import spsolve

from discrete.elements import Array
from homogenize.cell import Cell
from homogenize.relax import Flat

# Voigt: E11, E22 and 2 E12 as symmetric matrices
VOIGT = np.array([[[1.0, 0.0], [0.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], [[0.0, 0.5], [0.5, 0.0]]])


def membrane_tangent(cell: Cell, flat: Flat) -> Array:
    """(3, 3) N/mm per printed area: `W = 1/2 E^T A E`, Voigt strain `E = (a - a_r)/2` in the cell's coordinates.

    At rest the macroscopic forces vanish, so that only the first derivative of the cell vectors by the strain counts:
    `dF = F^-T E`.
    """
    cell.flat()
    pattern = cell.pattern
    low = pattern.lower(cell.hessian(flat.state, 0.0))
    full = (low + low.T).tolil()
    full.setdiag(low.diagonal())
    hessian = full.tocsc()
    number = np.full(cell.n_dofs, -1)
    number[cell.free] = np.arange(len(cell.free))
    macro = number[3 * cell.torus.n_base : 3 * cell.torus.n_base + 6]
    inner = np.setdiff1d(np.arange(pattern.size), macro)
    coupling = hessian[inner][:, macro].toarray()
    condensed = hessian[macro][:, macro].toarray() - coupling.T @ spsolve(hessian[inner][:, inner].tocsc(), coupling)
    moves = np.zeros((6, 3))
    for column, strain in enumerate(VOIGT):
        slope = np.linalg.solve(flat.deformation.T, strain)
        moves[:, column] = np.pad(cell.cell_vectors @ slope.T, ((0, 0), (0, 1))).ravel()
    return moves.T @ condensed @ moves / cell.area
