"""Is a stationary state a minimum? The smallest eigenvalue of its Hessian, rigid motions left out."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh, lobpcg

from equilibrium.linear.factor import Factor, Iterative
from equilibrium.linear.sparse_pattern import Floats, SparsePattern

MANY = 3000  # unknowns from which an iterative solver does not factorise
BLOCK = 4  # vectors iterated together: sheets with symmetries have double eigenvalues


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
        if factor.factorise(shifted) and (not isinstance(factor, Iterative) or factor.proves_definite()):
            break
        shift *= 10.0

    def project(v: Floats) -> Floats:
        return v - modes @ (modes.T @ v)

    def inverse(v: Floats) -> Floats:
        return project(factor.solve(project(v.ravel())))

    size = pattern.size
    start = project(np.random.default_rng(seed).standard_normal(size))
    operator = LinearOperator((size, size), matvec=inverse, dtype=float)
    if isinstance(factor, Iterative) and size > MANY:
        vector = _preconditioned(pattern, data, factor, modes, start)
    elif size - modes.shape[1] < 3:
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


def _preconditioned(pattern: SparsePattern, data: Floats, factor: Iterative, modes: Floats, start: Floats) -> Floats:
    """(size,) the lowest mode by LOBPCG (Knyazev 2001): a step preconditions where one of Lanczos would solve."""
    size = pattern.size
    block = np.column_stack([start, np.random.default_rng(1).standard_normal((size, BLOCK - 1))])
    low, diagonal = pattern.lower(data), data[pattern.diagonal]
    upper = low.T

    def times(v: Floats) -> Floats:
        return low @ v + upper @ v - (diagonal * v.T).T

    def nearly_solved(v: Floats) -> Floats:
        # the inverse would blow up what rounding leaves of the modes
        v = v.reshape(size, -1)
        v = v - modes @ (modes.T @ v)
        return np.column_stack([factor.precondition(np.ascontiguousarray(column)) for column in v.T])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # not converged: the residual says how good it is
        _, vectors = lobpcg(
            LinearOperator((size, size), matvec=times, matmat=times, dtype=float),
            block,
            M=LinearOperator((size, size), matvec=nearly_solved, matmat=nearly_solved, dtype=float),
            Y=modes if modes.shape[1] else None,
            largest=False,
            tol=1e-9,
            maxiter=300,
        )
    vector = vectors[:, 0]
    return vector - modes @ (modes.T @ vector)


def _dense(pattern: SparsePattern, data: Floats, modes: Floats) -> Floats:
    low = pattern.lower(data).toarray()
    full = low + np.tril(low, -1).T
    keep = np.eye(pattern.size) - modes @ modes.T
    # deflated modes are moved out of the way
    return keep @ full @ keep + (1.0 + np.abs(full).max() * pattern.size) * (np.eye(pattern.size) - keep)
