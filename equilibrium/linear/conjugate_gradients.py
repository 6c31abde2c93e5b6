"""Conjugate gradients that detect negative curvature, and a proof that a matrix is positive definite."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.equilibrium.arrays import Floats

Operator = Callable[[Floats], Floats]

# probability that a random vector has a smaller part along a direction than `proves_definite` assumes
FAILURE_PROBABILITY = 1e-9
# growth of the residual's energy that ends a proof; more than the condition number of a useful preconditioner
MAX_ENERGY_GROWTH = 1e6
MAX_PROOF_ITERATIONS = 3000
ZERO_CURVATURE_RATIO = 1e-10  # of the largest curvature; a smaller one may be zero up to rounding


class NotPositiveDefiniteError(ArithmeticError):
    """The iteration met a direction whose curvature is not positive: the matrix is not positive definite."""


class ConjugateGradients:
    """Preconditioned conjugate gradients for A x = b from x = 0 (Saad 2003, algorithm 9.1).

    Parameters
    ----------
    product : v -> A v, A symmetric.
    precondition : v -> M^-1 v, M symmetric and positive definite.
    b : (size,) right-hand side.

    Attributes
    ----------
    x, residual : (size,) the present solution and b - A x.
    energy : `r . M^-1 r` of the residual r.
    step_length : of the last step; it lies between the inverses of the extreme eigenvalues of M^-1 A.
    """

    def __init__(self, product: Operator, precondition: Operator, b: Floats) -> None:
        self._product, self._precondition = product, precondition
        self.x = np.zeros_like(b)
        self.residual = b.copy()
        z = precondition(b)
        self._direction = z
        self.energy = float(b @ z)
        self.step_length = 0.0

    def step(self) -> None:
        """One iteration.

        Raises
        ------
        NotPositiveDefiniteError
            The curvature along the next direction is not positive.
        """
        p = self._direction
        image = self._product(p)
        curvature = float(p @ image)
        if not curvature > 0.0:
            raise NotPositiveDefiniteError
        self.step_length = self.energy / curvature
        self.x += self.step_length * p
        self.residual -= self.step_length * image
        z = self._precondition(self.residual)
        energy = float(self.residual @ z)
        self._direction = z + (energy / self.energy) * p
        self.energy = energy


def solve_by_conjugate_gradients(
    product: Operator, precondition: Operator, b: Floats, tolerance: float, max_iterations: int
) -> tuple[Floats, int]:
    """Solution x (size,) with `|b - A x| <= tolerance |b|`, and the number of iterations.

    After `max_iterations` the last x is returned. It still is a descent direction of the energy with gradient -b.

    >>> A = np.array([[2.0, 1.0], [1.0, 3.0]])
    >>> x, iterations = solve_by_conjugate_gradients(A.dot, np.copy, np.array([1.0, 0.0]), 1e-12, 10)
    >>> x.round(6).tolist(), iterations
    ([0.6, -0.2], 2)
    """
    goal = tolerance * float(np.linalg.norm(b))
    if goal == 0.0:
        return np.zeros_like(b), 0
    run = ConjugateGradients(product, precondition, b)
    for k in range(1, max_iterations + 1):
        run.step()
        if np.linalg.norm(run.residual) <= goal:
            return run.x, k
    return run.x, max_iterations


def proves_definite(product: Operator, precondition: Operator, size: int, norm_bound: float, seed: int = 0) -> bool:
    """Whether A is proven positive definite, up to the probability FAILURE_PROBABILITY.

    False means that A is indefinite or that no proof was found.

    Conjugate gradients multiply the residual's part along an eigenvector of M^-1 A by `p(value)`. The polynomial p is 1
    at zero, and its roots, the Ritz values, are positive as long as all curvatures are positive. An eigenvalue that is
    not positive has p >= 1, so its part of the residual never decreases. A residual below the smallest part that a
    random right-hand side has along any direction therefore excludes such an eigenvalue. For normally distributed g
    this part is `xi^2 / |M|` in the norm `g . M^-1 g`, with a normally distributed number xi.

    Parameters
    ----------
    product, precondition : v -> A v and v -> M^-1 v; M is known to be positive definite.
    size : number of unknowns.
    norm_bound : upper bound of |M|.
    seed : of the random right-hand side.
    """
    run = ConjugateGradients(product, precondition, np.random.default_rng(seed).standard_normal(size))
    # P(|xi| < t) <= 0.8 t
    smallest_part = (FAILURE_PROBABILITY / 0.8) ** 2 / norm_bound
    shortest, first_energy = np.inf, run.energy
    try:
        for _ in range(MAX_PROOF_ITERATIONS):
            run.step()
            shortest = min(shortest, run.step_length)
            # a curvature that may be zero, or a residual dominated by amplified rounding errors
            if run.step_length > shortest / ZERO_CURVATURE_RATIO or run.energy > MAX_ENERGY_GROWTH * first_energy:
                return False
            if run.energy < smallest_part:
                return True
    except NotPositiveDefiniteError:
        pass
    return False
