"""The certificate of a minimum, which is the smallest eigenvalue without rigid motions, and how to leave a saddle."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh, lobpcg

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor, IterativeFactor
from asterism.equilibrium.linear.sparse_pattern import SparsePattern
from asterism.equilibrium.newton.problem import AnyState, Problem

MAX_LANCZOS_UNKNOWNS = 3000  # of iterative solvers; larger problems use LOBPCG, which needs no accurate solutions
FIRST_SHIFT = 1e-9  # added to the diagonal


@dataclass(frozen=True)
class Eigenpair:
    """Smallest eigenvalue, with its error bound."""

    value: float  # Rayleigh quotient of `vector`
    vector: Floats  # (size,) unit vector, orthogonal to the deflated modes
    error: float  # norm of the residual; at least one eigenvalue lies in `value` +- `error`
    factorisations: int  # their number


def smallest_eigenvalue(
    pattern: SparsePattern, data: Floats, factor: Factor, modes: Floats, seed: int = 0
) -> Eigenpair:
    """Smallest eigenvalue of a symmetric matrix H on the orthogonal complement of orthonormal `modes` (size, k).

    Lanczos iteration with the inverse of `H + shift I`. The shift grows until this matrix is positive definite, so that
    no eigenvalue is missed below. If H does not exactly map the modes to zero, the value is that of the projected H.
    Raises `FloatingPointError` if the matrix is not finite.

    The softest mode of a free chain of two unit springs, without its translation:

    >>> from asterism.equilibrium.linear.backends import make_factor
    >>> pattern = SparsePattern([np.array([[0, 1], [1, 2]])], 3, np.arange(3))
    >>> data = pattern.assemble([np.array([[1.0, -1.0, 1.0], [1.0, -1.0, 1.0]])])
    >>> translation = np.full((3, 1), 3.0**-0.5)
    >>> pair = smallest_eigenvalue(pattern, data, make_factor(pattern, "superlu"), translation)
    >>> round(pair.value, 6)
    1.0
    """
    if not np.isfinite(data).all():
        raise FloatingPointError("the Hessian is not finite")
    factorisations, shift = 0, FIRST_SHIFT
    while True:
        shifted = data.copy()
        shifted[pattern.diagonal] += shift
        factorisations += 1
        if factor.factorise(shifted) and (not isinstance(factor, IterativeFactor) or factor.proves_definite()):
            break
        shift *= 10.0

    def project(v: Floats) -> Floats:
        return v - modes @ (modes.T @ v)

    def inverse(v: Floats) -> Floats:
        return project(factor.solve(project(v.ravel())))

    size = pattern.size
    start = project(np.random.default_rng(seed).standard_normal(size))
    operator = LinearOperator((size, size), matvec=inverse, dtype=float)
    if isinstance(factor, IterativeFactor) and size > MAX_LANCZOS_UNKNOWNS:
        vector = _lobpcg_mode(pattern, data, factor, modes, start)
    elif size - modes.shape[1] < 3:
        _, vectors = np.linalg.eigh(_dense(pattern, data, modes))
        vector = vectors[:, 0]
    else:
        # a negative eigenvalue needs an accurate mode: it decides which way a saddle is left. Otherwise the smallest
        # eigenvalue is wanted, whose relative error is about the square of the tolerance.
        loose = factorisations == 1
        ncv, tolerance = (min(8, size), 1e-6) if loose else (None, 1e-9)
        try:
            _, vectors = eigsh(operator, k=1, which="LA", v0=start, ncv=ncv, tol=tolerance, maxiter=400)
        except ArpackNoConvergence as stopped:  # the residual below measures the error
            vectors = stopped.eigenvectors if len(stopped.eigenvalues) else start[:, None]
        vector = project(vectors[:, 0])
    vector = vector / np.linalg.norm(vector)
    image = project(pattern.product(data, vector))
    value = float(vector @ image)
    return Eigenpair(value, vector, float(np.linalg.norm(image - value * vector)), factorisations)


def _lobpcg_mode(pattern: SparsePattern, data: Floats, factor: IterativeFactor, modes: Floats, start: Floats) -> Floats:
    """Lowest mode (size,) by LOBPCG (Knyazev 2001), whose steps precondition where Lanczos steps solve."""
    size = pattern.size
    # symmetric sheets have double eigenvalues
    block = np.column_stack([start, np.random.default_rng(1).standard_normal((size, 3))])

    times = pattern.multiplier(data)

    def precondition_projected(v: Floats) -> Floats:
        # the preconditioner would amplify the modes that rounding errors leave
        v = v.reshape(size, -1)
        v = v - modes @ (modes.T @ v)
        return np.column_stack([factor.precondition(np.ascontiguousarray(column)) for column in v.T])

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # not converged: the residual measures the error
        _, vectors = lobpcg(
            LinearOperator((size, size), matvec=times, matmat=times, dtype=float),
            block,
            M=LinearOperator((size, size), matvec=precondition_projected, matmat=precondition_projected, dtype=float),
            Y=modes if modes.shape[1] else None,
            largest=False,
            tol=1e-9,
            maxiter=300,
        )
    vector: Floats = vectors[:, 0]
    return np.asarray(vector - modes @ (modes.T @ vector))


def _dense(pattern: SparsePattern, data: Floats, modes: Floats) -> Floats:
    full = pattern.full(data).toarray()
    keep = np.eye(pattern.size) - modes @ modes.T
    # deflated modes get an eigenvalue above all others
    return np.asarray(keep @ full @ keep + (1.0 + np.abs(full).max() * pattern.size) * (np.eye(pattern.size) - keep))


def leave_saddle(problem: Problem, state: AnyState, mode: Floats, max_change: float) -> AnyState:
    """State moved along a mode (size,) of negative curvature, to the lower side, as far as the energy decreases.

    No free unknown changes by more than `max_change`. At a symmetric saddle both sides are equal, and rounding errors
    would choose between them. A fixed pseudo-random vector chooses instead.
    """
    reference = np.random.default_rng(0).standard_normal(len(mode))
    vector = mode if reference @ mode >= 0.0 else -mode
    energy = problem.energy(state)
    (first, e1), (second, e2) = (_lowest_along(problem, state, energy, side, max_change) for side in (vector, -vector))
    # sides of a saddle that differ by less count as equal
    return second if e2 < e1 - 0.01 * abs(energy - e1) else first


def _lowest_along(
    problem: Problem, state: AnyState, energy: float, vector: Floats, max_change: float
) -> tuple[AnyState, float]:
    lowest_state, lowest = state, energy
    path, longest = problem.path(state, vector)
    step = min(longest, max_change / float(np.abs(vector).max()))
    for _ in range(12):
        trial = path(step)
        trial_energy = problem.energy(trial)
        if trial_energy < lowest:
            lowest_state, lowest = trial, trial_energy
        step *= 0.5
    return lowest_state, lowest
