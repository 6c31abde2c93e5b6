"""Conjugate gradients that notice negative curvature, and what their coefficients prove about the matrix."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import eigvalsh_tridiagonal

from equilibrium.sparse_pattern import Floats

Operator = Callable[[Floats], Floats]

UNLUCKY = 1e-9  # probability that a random vector misses a direction by more than `proves_definite` allows for


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
    alpha, beta : coefficients so far; they are the Lanczos matrix of M^-1 A started at M^-1 b.
    """

    def __init__(self, product: Operator, precondition: Operator, b: Floats) -> None:
        self._product, self._precondition = product, precondition
        self.x = np.zeros_like(b)
        self.residual = b.copy()
        z = precondition(b)
        self._direction = z
        self._rz = self.start = float(b @ z)
        self.alpha: list[float] = []
        self.beta: list[float] = []

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
        a = self._rz / curvature
        self.x += a * p
        self.residual -= a * image
        z = self._precondition(self.residual)
        rz = float(self.residual @ z)
        b = rz / self._rz
        self._direction = z + b * p
        self._rz = rz
        self.alpha.append(a)
        self.beta.append(b)

    def ritz(self) -> tuple[float, float]:
        """Smallest and largest eigenvalue of the Lanczos matrix, bounds from inside for those of M^-1 A."""
        a, b = np.array(self.alpha), np.array(self.beta[:-1])
        diagonal = 1.0 / a
        diagonal[1:] += b / a[:-1]
        values = eigvalsh_tridiagonal(diagonal, np.sqrt(b) / a[:-1])
        return float(values[0]), float(values[-1])


def solved(product: Operator, precondition: Operator, b: Floats, tolerance: float, max_iterations: int) -> Floats:
    """x with `|b - A x| <= tolerance |b|`, or the last of `max_iterations`, which still leads downhill."""
    goal = tolerance * float(np.linalg.norm(b))
    if goal == 0.0:
        return np.zeros_like(b)
    run = ConjugateGradients(product, precondition, b)
    for _ in range(max_iterations):
        run.step()
        if np.linalg.norm(run.residual) <= goal:
            break
    return run.x


def proves_definite(
    product: Operator, precondition: Operator, size: int, largest: float, seed: int = 0, max_iterations: int = 3000
) -> bool:
    """Is A positive definite? True is proven up to the probability UNLUCKY, False is not known or not so.

    If M^-1 A had an eigenvalue that is not positive, k Lanczos steps from a random start would have found a value
    below `e + sec(phi)^2 top / T(k - 1)^2` for any e > 0, with the Chebyshev polynomial T at `(top + e)/(top - e)` and
    the angle phi between start and eigenvector (after Kuczynski and Wozniakowski 1992: take that polynomial in the
    Rayleigh quotient). Here e is half of what they did find. The start is M^-1 g with normally distributed g, and then
    `sec(phi)^2 <= (g . M^-1 g) |M| / xi^2` with a normally distributed number xi.

    Parameters
    ----------
    product, precondition : v -> A v and v -> M^-1 v; M is known to be positive definite.
    largest : a bound of |M|.
    """
    g = np.random.default_rng(seed).standard_normal(size)
    run = ConjugateGradients(product, precondition, g)
    # P(|xi| < t) <= 0.8 t
    angle = np.log(run.start) + np.log(largest) - 2.0 * np.log(UNLUCKY / 0.8)
    try:
        for k in range(1, max_iterations + 1):
            run.step()
            if k % 10 and k != size:
                continue
            low, top = run.ritz()
            if low <= 0.0:
                return False
            top = max(1.1 * top, 1.0)
            e = 0.5 * low
            growth = (k - 1) * np.arccosh((top + e) / (top - e)) - np.log(2.0)
            if k >= size or 2.0 * growth > angle + np.log(top / e):
                return True
            if run.beta[-1] == 0.0:
                return False
    except NotPositiveDefinite:
        return False
    return False
