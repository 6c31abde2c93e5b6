"""Is a stationary state a minimum? The smallest eigenvalue of its Hessian, rigid motions left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from equilibrium.factor import Factor
from equilibrium.sparse_pattern import Floats, SparsePattern


@dataclass(frozen=True)
class Eigenpair:
    """Smallest eigenvalue with its evidence.

    Attributes
    ----------
    value : Rayleigh quotient of `vector`.
    vector : (size,) unit, orthogonal to the deflated modes.
    error : norm of the residual; an eigenvalue lies within it of `value`.
    factorisations : spent on it.
    """

    value: float
    vector: Floats
    error: float
    factorisations: int


def smallest_eigenvalue(
    pattern: SparsePattern, data: Floats, factor: Factor, modes: Floats, shift: float = 1e-9, seed: int = 0
) -> Eigenpair:
    """Smallest eigenvalue of a symmetric matrix on the complement of `modes` (size, k), orthonormal.

    Raises FloatingPointError for a matrix that is not finite.

    Lanczos with the inverse of `H + shift I`; the shift grows until that is positive definite, so that no eigenvalue
    can lie below what is found. Both `H` and the modes are used as they are: for modes that `H` does not quite map to
    zero the value is that of the projected matrix.
    """
    if not np.isfinite(data).all():
        raise FloatingPointError("the Hessian is not finite")
    factorisations = 0
    while True:
        shifted = data.copy()
        shifted[pattern.diagonal] += shift
        factorisations += 1
        if factor.factorise(shifted):
            break
        shift *= 10.0

    def project(v: Floats) -> Floats:
        return v - modes @ (modes.T @ v)

    def inverse(v: Floats) -> Floats:
        return project(factor.solve(project(v.ravel())))

    size = pattern.size
    start = project(np.random.default_rng(seed).standard_normal(size))
    operator = LinearOperator((size, size), matvec=inverse, dtype=float)
    if size - modes.shape[1] < 3:
        _, vectors = np.linalg.eigh(_dense(pattern, data, modes))
        vector = vectors[:, 0]
    else:
        try:
            _, vectors = eigsh(operator, k=1, which="LA", v0=start, tol=1e-9, maxiter=400)
        except ArpackNoConvergence as stopped:  # the residual below says how good it is
            vectors = stopped.eigenvectors if len(stopped.eigenvalues) else start[:, None]
        vector = project(vectors[:, 0])
    vector = vector / np.linalg.norm(vector)
    image = project(pattern.product(data, vector))
    value = float(vector @ image)
    return Eigenpair(value, vector, float(np.linalg.norm(image - value * vector)), factorisations)


def _dense(pattern: SparsePattern, data: Floats, modes: Floats) -> Floats:
    low = pattern.lower(data).toarray()
    full = low + np.tril(low, -1).T
    keep = np.eye(pattern.size) - modes @ modes.T
    # deflated modes are moved out of the way
    return keep @ full @ keep + (1.0 + np.abs(full).max() * pattern.size) * (np.eye(pattern.size) - keep)
