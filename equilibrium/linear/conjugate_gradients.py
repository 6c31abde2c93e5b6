"""Conjugate gradients that notice negative curvature, and what their residual proves about the matrix."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from equilibrium.linear.sparse_pattern import Floats

Operator = Callable[[Floats], Floats]

UNLUCKY = 1e-9  # probability that a random vector has less of a direction than `proves_definite` takes for granted
GROWTH = 1e6  # of the residual's energy: more than the condition number of any preconditioner worth the name
LONGEST = 3000  # iterations of `proves_definite`
ROUNDING = 1e-10  # curvatures below this, relative to the largest, may be zero


class NotPositiveDefinite(ArithmeticError):
    """A direction of no or negative curvature was met: the matrix is not positive definite."""


class ConjugateGradients:
    """Preconditioned conjugate gradients from zero.

    Parameters
    ----------
    product : v -> A v, A symmetric.
    precondition : v -> M^-1 v, symmetric and positive definite.
    b : (size,) right hand side.

    Attributes
    ----------
    x, residual : (size,) the present solution and b - A x.
    energy : `r . M^-1 r` of the residual r.
    length : of the last step, from the inverse of M^-1 A's largest eigenvalue to that of its smallest.
    """

    def __init__(self, product: Operator, precondition: Operator, b: Floats) -> None:
        self._product, self._precondition = product, precondition
        self.x = np.zeros_like(b)
        self.residual = b.copy()
        z = precondition(b)
        self._direction = z
        self.energy = float(b @ z)
        self.length = 0.0

    def step(self) -> None:
        """One iteration.

        Raises
        ------
        NotPositiveDefinite
            The next direction has no positive curvature.
        """
        p = self._direction
        image = self._product(p)
        curvature = float(p @ image)
        if not curvature > 0.0:
            raise NotPositiveDefinite
        self.length = self.energy / curvature
        self.x += self.length * p
        self.residual -= self.length * image
        z = self._precondition(self.residual)
        energy = float(self.residual @ z)
        self._direction = z + (energy / self.energy) * p
        self.energy = energy


def solved(
    product: Operator, precondition: Operator, b: Floats, tolerance: float, max_iterations: int
) -> tuple[Floats, int]:
    """x with `|b - A x| <= tolerance |b|`, or the last of `max_iterations`, still a way down; and the iterations."""
    goal = tolerance * float(np.linalg.norm(b))
    if goal == 0.0:
        return np.zeros_like(b), 0
    run = ConjugateGradients(product, precondition, b)
    for k in range(1, max_iterations + 1):
        run.step()
        if np.linalg.norm(run.residual) <= goal:
            return run.x, k
    return run.x, max_iterations


def proves_definite(product: Operator, precondition: Operator, size: int, largest: float, seed: int = 0) -> bool:
    """Is A positive definite? True is proven up to the probability UNLUCKY, False is not known or not so.

    Conjugate gradients multiply the residual's part along an eigenvector of M^-1 A by `p(value)`, where the polynomial
    p is 1 at zero and its roots, the Ritz values, are positive as long as all curvatures are. An eigenvalue that is not
    positive has p >= 1: its part of the residual never falls. So a residual below the least part that a random right
    hand side has in any direction leaves no such eigenvalue. For normally distributed g that part is `xi^2 / |M|`, with
    a normally distributed number xi, in the norm `g . M^-1 g`.

    Parameters
    ----------
    product, precondition : v -> A v and v -> M^-1 v; M is known to be positive definite.
    largest : a bound of |M|.
    """
    run = ConjugateGradients(product, precondition, np.random.default_rng(seed).standard_normal(size))
    # P(|xi| < t) <= 0.8 t
    least = (UNLUCKY / 0.8) ** 2 / largest
    shortest, start = np.inf, run.energy
    try:
        for _ in range(LONGEST):
            run.step()
            shortest = min(shortest, run.length)
            # a curvature that may be zero, or a residual in which rounding has been blown up
            if run.length > shortest / ROUNDING or run.energy > GROWTH * start:
                return False
            if run.energy < least:
                return True
    except NotPositiveDefinite:
        pass
    return False
