"""The softest modes of an equilibrium, measured so that they do not depend on the unknowns."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from equilibrium.factor import Factor
from equilibrium.sparse_pattern import Floats


def soft_modes(mass: sp.csr_matrix, factor: Factor, rigid: Floats, count: int) -> tuple[Floats, Floats]:
    """(k,) smallest eigenvalues of `H v = value M v` and their modes (size, k), `v M v = 1`, rigid motions left out.

    Parameters
    ----------
    mass : (size, size) M, positive definite.
    factor : holds H, positive definite, stiffened where it stops the rigid motions (an isostatic support).
    rigid : (size, r) motions that H maps to zero; r may be 0.
    count : modes wanted; fewer come back where the iteration finds fewer.
    """
    size = mass.shape[0]
    count = min(count, size - rigid.shape[1] - 1)
    if count < 1:
        return np.empty(0), np.empty((size, 0))
    weighted = mass @ rigid
    inner = np.linalg.inv(rigid.T @ weighted) if rigid.shape[1] else np.empty((0, 0))

    def inverse(f: Floats) -> Floats:
        # a force in equilibrium with itself leaves the support alone
        f = f.ravel() - weighted @ (inner @ (rigid.T @ f.ravel()))
        v = factor.solve(f)
        return v - rigid @ (inner @ (weighted.T @ v))

    operator = LinearOperator((size, size), matvec=inverse, dtype=float)
    start = inverse(mass @ np.random.default_rng(0).standard_normal(size))
    try:
        values, vectors = eigsh(operator, k=count, M=mass, sigma=0.0, OPinv=operator, v0=start, tol=1e-6, maxiter=100)
    except ArpackNoConvergence as stopped:
        values, vectors = stopped.eigenvalues, stopped.eigenvectors
    order = np.argsort(values)
    return values[order], vectors[:, order]
