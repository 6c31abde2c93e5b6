"""A linear Kirchhoff plate, to test elements and conditions against closed forms."""

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

from asterism.fem.elements.deformation import flat
from asterism.fem.supports.conditions import Condition, impose_conditions

STIFF = 1e7


def plate_matrix(space, poisson: float) -> sp.csr_matrix:
    """(N, N) matrix of the bending energy of unit stiffness."""
    table = space.tabulate(10)
    law = np.array([[1, poisson, 0], [poisson, 1, 0], [0, 0, 2 * (1 - poisson)]])
    blocks = np.einsum("tq,tqic,cd,tqjd->tij", table.weights, table.hessians, law, table.hessians)
    width = table.dofs.shape[1]
    rows, columns = np.repeat(table.dofs, width, axis=1), np.tile(table.dofs, width)
    return sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(space.size,) * 2)


def uniform_load(space) -> np.ndarray:
    """(N,) load of 1 per area."""
    table = space.tabulate(10)
    load = np.zeros(space.size)
    np.add.at(load, table.dofs, np.einsum("tq,tqm->tm", table.weights, table.values))
    return load


def deflection(space, conditions: list[Condition], load: np.ndarray, poisson: float = 0.3) -> np.ndarray:
    """(N,) deflections of a plate whose positions, all three components, meet the conditions.

    In its plane it stays as printed, but for what the conditions say: a stiff spring at every dof sees to it.
    """
    reduction = impose_conditions(space, conditions)
    out, inplane = np.diag([0.0, 0.0, 1.0]), np.diag([STIFF, STIFF, 0.0])
    matrix = sp.kron(plate_matrix(space, poisson), out) + sp.kron(sp.identity(space.size), inplane)
    forces = STIFF * space.interpolate(flat().jets)
    forces[:, 2] = load
    offset = reduction.offset()
    right = reduction.map.T @ (forces.ravel() - matrix @ offset)
    q = spsolve((reduction.map.T @ matrix @ reduction.map).tocsc(), right)
    return reduction.positions(q)[:, 2]


def height(space, heights: np.ndarray, x: float, y: float) -> float:
    """Deflection at a printed point."""
    return float((space.locate(np.array([[x, y]])).value @ heights)[0])
