"""The softest modes of an equilibrium, measured so that they do not depend on the unknowns."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.linalg import eigh

from equilibrium.factor import Factor
from equilibrium.sparse_pattern import Floats

GUARDS = 4  # further vectors that iterate along: the first ones converge at the pace of the first that is left out
SETTLED = 1e-7  # relative change of the eigenvalues at which they are taken
MOST = 60  # iterations


def soft_modes(mass: sp.csr_matrix, factor: Factor, rigid: Floats, count: int) -> tuple[Floats, Floats]:
    """(k,) smallest eigenvalues of `H v = value M v` and their modes (size, k), `v M v = 1`, rigid motions left out.

    By subspace iteration (Bathe 1971) with the inverse of H.

    Parameters
    ----------
    mass : (size, size) M, positive definite.
    factor : holds H, positive definite, stiffened where it stops the rigid motions (an isostatic support).
    rigid : (size, r) motions that H maps to zero; r may be 0.
    count : modes wanted; fewer come back if there are fewer.
    """
    size = mass.shape[0]
    count = min(count, size - rigid.shape[1])
    if count < 1:
        return np.empty(0), np.empty((size, 0))
    weighted = mass @ rigid
    inner = np.linalg.inv(rigid.T @ weighted) if rigid.shape[1] else np.empty((0, 0))
    width = min(count + GUARDS, size - rigid.shape[1])
    forces = mass @ np.random.default_rng(0).standard_normal((size, width))
    values = np.zeros(width)
    for _ in range(MOST):
        # forces in equilibrium with themselves leave the support alone
        forces = forces - weighted @ (inner @ (rigid.T @ forces))
        vectors = np.ascontiguousarray(factor.solve(forces))
        vectors -= rigid @ (inner @ (weighted.T @ vectors))
        images = mass @ vectors
        before = values
        values, turn = eigh(vectors.T @ forces, vectors.T @ images)
        vectors, forces = vectors @ turn, images @ turn
        if np.abs(values - before)[:count].max() <= SETTLED * abs(values[count - 1]):
            break
    return values[:count], vectors[:, :count]
