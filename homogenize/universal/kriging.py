"""Interpolation of scattered cells: kriging with a Matern kernel, one length for each coordinate.

The function is a sum of kernels about the cells (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006,
eqs. 2.25, 4.17 and 5.12). Every kernel carries the factor `u(x) u(x')`. With the arm's length as u the function is
exactly zero for stars without arms, the bare fabric. The lengths and the noise maximise the likelihood of the cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, lapack
from scipy.optimize import minimize

from equilibrium.arrays import Floats

# bounds of the lengths, in coordinates from 0 to 1, and of the noise over the variance
LENGTH_BOUNDS = (0.1, 30.0)
NOISE_BOUNDS = (1e-8, 1.0)
FIRST_LENGTH = 1.5
FIRST_NOISE = 1e-3
MAX_LIKELIHOOD_STEPS = 80
# cells that the lengths are fitted to; time grows with the third power
MAX_LIKELIHOOD_CELLS = 800
# seed of the choice of these cells
_CHOICE_SEED = 0
# places that are evaluated together; with 64, or all at once, 4458 cells take 1.3 and 3.1 times as long
_BLOCK = 16


@dataclass(frozen=True)
class Kriging:
    """C functions of G coordinates that share their lengths.

    Attributes
    ----------
    places : (n, G) coordinates of the cells.
    factors : (n,) u at the cells.
    lengths : (G,) lengths of the kernel.
    noise : variance of the cells' scatter over that of the kernel.
    weights : (n, C).

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 9)[:, None]
    >>> line = Kriging.through(x, np.ones(9), 3.0 * x - 1.0, np.array([1.0]), 1e-8)
    >>> line.values(np.array([[0.43]]), np.ones(1)).round(3)
    array([[0.29]])
    """

    places: Floats
    factors: Floats
    lengths: Floats
    noise: float
    weights: Floats

    @classmethod
    def through(cls, places: Floats, factors: Floats, values: Floats, lengths: Floats, noise: float) -> Kriging:
        """The functions through (n, C) values, apart from the noise."""
        matrix = _matrix(places, factors, lengths, noise)
        return cls(places, factors, lengths, noise, cho_solve(cho_factor(matrix, lower=True), values))

    def values(self, places: Floats, factors: Floats) -> Floats:
        """(N, C) at places (N, G) with the factors (N,)."""
        # one product gives the squared distances (times 5) of a block of places, which stays in the processor's cache
        own, asked = (np.sqrt(5.0) * each / self.lengths for each in (self.places, places))
        ones = np.ones((len(own), 1))
        others = np.hstack([-2.0 * own, ones, (own**2).sum(axis=1)[:, None]]).T.copy()
        ones = np.ones((len(asked), 1))
        asked = np.hstack([asked, (asked**2).sum(axis=1)[:, None], ones])
        rows = self.factors[:, None] * self.weights
        found = np.empty((len(asked), rows.shape[1]))
        for first in range(0, len(asked), _BLOCK):
            block = slice(first, first + _BLOCK)
            kernel = asked[block] @ others
            np.maximum(kernel, 0.0, out=kernel)
            scaled = np.sqrt(kernel)
            # (1 + r + r^2/3) exp(-r), as in `_kernel`
            kernel *= 1.0 / 3.0
            kernel += scaled
            kernel += 1.0
            np.exp(np.negative(scaled, out=scaled), out=scaled)
            kernel *= scaled
            np.matmul(kernel, rows, out=found[block])
        return factors[:, None] * found

    def left_out(self, values: Floats) -> Floats:
        """(n, C) what the other cells give at each cell, with the lengths of all; `values` are those of the cells."""
        inverse = np.linalg.inv(_matrix(self.places, self.factors, self.lengths, self.noise))
        return np.asarray(values - self.weights / np.diag(inverse)[:, None])


def likely_lengths(places: Floats, factors: Floats, values: Floats) -> tuple[Floats, float]:
    """Lengths (G,) and noise that make the values (n,) most likely. Equal cells give equal numbers.

    Of more than `MAX_LIKELIHOOD_CELLS` cells a random choice is used.
    """
    count = places.shape[1]
    chosen = np.random.default_rng(_CHOICE_SEED).permutation(len(values))[:MAX_LIKELIHOOD_CELLS]
    start = np.log([*[FIRST_LENGTH] * count, FIRST_NOISE])
    bounds = [tuple(np.log(LENGTH_BOUNDS))] * count + [tuple(np.log(NOISE_BOUNDS))]
    best = minimize(
        _negative_log_likelihood,
        start,
        args=(places[chosen], factors[chosen], values[chosen]),
        jac=True,
        method="L-BFGS-B",
        bounds=bounds,
        options={"maxiter": MAX_LIKELIHOOD_STEPS},
    ).x
    return np.exp(best[:-1]), float(np.exp(best[-1]))


def _kernel(places: Floats, others: Floats, lengths: Floats) -> tuple[Floats, Floats]:
    """Matern kernel (N, n) with two derivatives, and its argument `r = sqrt(5) |x - x'|` in scaled coordinates."""
    a, b = places / lengths, others / lengths
    squares = (a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1) - 2.0 * a @ b.T
    scaled = np.sqrt(5.0 * np.maximum(squares, 0.0))
    return (1.0 + scaled + scaled**2 / 3.0) * np.exp(-scaled), scaled


def _matrix(places: Floats, factors: Floats, lengths: Floats, noise: float) -> Floats:
    kernel, _ = _kernel(places, places, lengths)
    return np.asarray(factors[:, None] * factors * kernel + noise * np.eye(len(places)))


def _negative_log_likelihood(
    logarithms: Floats, places: Floats, factors: Floats, values: Floats
) -> tuple[float, Floats]:
    """Minus the logarithm of the likelihood with the best variance, and its gradient by the logarithms."""
    lengths, noise, n = np.exp(logarithms[:-1]), float(np.exp(logarithms[-1])), len(values)
    kernel, scaled = _kernel(places, places, lengths)
    both = factors[:, None] * factors
    low, failed = lapack.dpotrf(both * kernel + noise * np.eye(n), lower=1)
    if failed:
        return 1e10, np.zeros_like(logarithms)
    half = np.tril(lapack.dpotri(low, lower=1)[0])
    inverse = half + np.tril(half, -1).T
    weights = inverse @ values
    variance = float(values @ weights) / n
    loss = 0.5 * n * np.log(variance) + np.log(np.diag(low)).sum()
    spread = inverse - np.outer(weights, weights) / variance
    base = spread * both * (5.0 / 3.0) * (1.0 + scaled) * np.exp(-scaled)
    rows = base.sum(axis=1)
    gradient = np.empty_like(logarithms)
    for axis, length in enumerate(lengths):
        x = places[:, axis] / length
        gradient[axis] = rows @ x**2 - x @ base @ x
    gradient[-1] = 0.5 * noise * np.trace(spread)
    return float(loss), gradient
