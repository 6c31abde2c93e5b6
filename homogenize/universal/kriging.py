"""Interpolation of scattered cells: kriging with a Matern kernel, one length for each coordinate.

The function is a sum of kernels about the cells (Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006,
eqs. 2.25 and 4.17). Every kernel carries the factor `u(x) u(x')`. With the arm's length as u the function is exactly
zero for stars without arms, the bare fabric. The scatter of the cells varies over the range: thin fabrics, and arms
near their buckling, have most.

The covariance is the one that makes the values of scattered cells most likely (eq. 5.9), with the best variance of the
kernel, and with a scatter whose logarithm is linear in the coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, lapack
from scipy.optimize import minimize

from asterism.equilibrium.arrays import Floats

# of every cell, beside its scatter; keeps equal cells apart from singular matrices
MIN_NOISE = 1e-8
# places that are evaluated together; with 64, or all at once, 4458 cells take 1.3 and 3.1 times as long
_BLOCK = 16
# bounds of the lengths, in coordinates from 0 to 1, of the noise over the variance, and of the slopes of its logarithm
LENGTH_BOUNDS = (0.1, 30.0)
NOISE_BOUNDS = (1e-8, 1.0)
MAX_NOISE_SLOPE = 20.0
FIRST_LENGTH = 1.5
FIRST_NOISE = 1e-3
MAX_LIKELIHOOD_STEPS = 80
# cells that the covariance is fitted to; time grows with the third power
MAX_LIKELIHOOD_CELLS = 1600
# seed of the choice of these cells
_CHOICE_SEED = 0


@dataclass(frozen=True)
class Covariance:
    """Lengths of the kernel, and scatter of the cells.

    Attributes
    ----------
    lengths : (G,) lengths of the kernel.
    noise : variance of the cells' scatter in the middle of the range, where all coordinates are 1/2, over that of the
        kernel.
    noise_slopes : (G,) of its logarithm by the coordinates.
    """

    lengths: Floats
    noise: float
    noise_slopes: Floats

    @classmethod
    def even(cls, lengths: Floats, noise: float) -> Covariance:
        """With the same scatter everywhere."""
        return cls(lengths, noise, np.zeros(len(lengths)))

    def scatter(self, places: Floats) -> Floats:
        """(n,) variances at places (n, G), without `MIN_NOISE`."""
        return np.asarray(self.noise * np.exp((places - 0.5) @ self.noise_slopes))

    def matrix(self, places: Floats, factors: Floats) -> Floats:
        """(n, n) covariances of cells at places (n, G) with the factors (n,)."""
        covariances = factors[:, None] * factors * matern(places, self.lengths)[0]
        covariances[np.diag_indices(len(places))] += self.scatter(places) + MIN_NOISE
        return np.asarray(covariances)


@dataclass(frozen=True)
class Kriging:
    """C functions of G coordinates that share their lengths.

    Attributes
    ----------
    places : (n, G) coordinates of the cells.
    factors : (n,) u at the cells.
    covariance : of the cells.
    weights : (n, C).

    Examples
    --------
    >>> x = np.linspace(0.0, 1.0, 9)[:, None]
    >>> line = Kriging.through(x, np.ones(9), 3.0 * x - 1.0, Covariance.even(np.array([1.0]), 1e-8))
    >>> line.values(np.array([[0.43]]), np.ones(1)).round(3)
    array([[0.29]])
    """

    places: Floats
    factors: Floats
    covariance: Covariance
    weights: Floats

    @classmethod
    def through(cls, places: Floats, factors: Floats, values: Floats, covariance: Covariance) -> Kriging:
        """The functions through (n, C) values, apart from the scatter."""
        matrix = covariance.matrix(places, factors)
        return cls(places, factors, covariance, cho_solve(cho_factor(matrix, lower=True), values))

    def values(self, places: Floats, factors: Floats) -> Floats:
        """(N, C) at places (N, G) with the factors (N,)."""
        # one product gives the squared distances (times 5) of a block of places, which stays in the processor's cache
        own, asked = (np.sqrt(5.0) * each / self.covariance.lengths for each in (self.places, places))
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
            # (1 + r + r^2/3) exp(-r), as in `matern`
            kernel *= 1.0 / 3.0
            kernel += scaled
            kernel += 1.0
            np.exp(np.negative(scaled, out=scaled), out=scaled)
            kernel *= scaled
            np.matmul(kernel, rows, out=found[block])
        return factors[:, None] * found

    def left_out(self, values: Floats) -> Floats:
        """(n, C) what the other cells give at each cell, with the covariance of all; `values` are the cells' own."""
        inverse = np.linalg.inv(self.covariance.matrix(self.places, self.factors))
        return np.asarray(values - self.weights / np.diag(inverse)[:, None])


def matern(places: Floats, lengths: Floats) -> tuple[Floats, Floats]:
    """Matern kernel (n, n) with two derivatives, and its argument `r = sqrt(5) |x - x'|` in scaled coordinates."""
    scaled_places = places / lengths
    norms = (scaled_places**2).sum(axis=1)
    squares = norms[:, None] + norms - 2.0 * scaled_places @ scaled_places.T
    scaled = np.sqrt(5.0 * np.maximum(squares, 0.0))
    return (1.0 + scaled + scaled**2 / 3.0) * np.exp(-scaled), scaled


def likely_covariance(places: Floats, factors: Floats, values: Floats, even_noise: bool = False) -> Covariance:
    """The covariance that makes the values (n,) at places (n, G) most likely. Equal cells give equal numbers.

    Of more than `MAX_LIKELIHOOD_CELLS` cells a random choice is used.

    Parameters
    ----------
    even_noise : the scatter is the same everywhere.
    """
    count = places.shape[1]
    chosen = np.random.default_rng(_CHOICE_SEED).permutation(len(values))[:MAX_LIKELIHOOD_CELLS]
    slope = 0.0 if even_noise else MAX_NOISE_SLOPE
    start = np.concatenate([np.log([*[FIRST_LENGTH] * count, FIRST_NOISE]), np.zeros(count)])
    bounds = [tuple(np.log(LENGTH_BOUNDS))] * count + [tuple(np.log(NOISE_BOUNDS))] + [(-slope, slope)] * count
    best = minimize(
        negative_log_likelihood,
        start,
        args=(places[chosen], factors[chosen], values[chosen]),
        jac=True,
        method="L-BFGS-B",
        bounds=bounds,
        options={"maxiter": MAX_LIKELIHOOD_STEPS},
    ).x
    return _covariance(best, count)


def negative_log_likelihood(
    parameters: Floats, places: Floats, factors: Floats, values: Floats
) -> tuple[float, Floats]:
    """Minus the logarithm of the likelihood with the best variance, and its gradient (2 G + 1,).

    Parameters
    ----------
    parameters : (2 G + 1,) logarithms of the lengths and of the noise, then the slopes of the noise.
    places, factors, values : (n, G), (n,), (n,).
    """
    n, count = places.shape
    covariance = _covariance(parameters, count)
    _, scaled = matern(places, covariance.lengths)
    low, failed = lapack.dpotrf(covariance.matrix(places, factors), lower=1)
    if failed:
        return 1e10, np.zeros_like(parameters)
    half = np.tril(lapack.dpotri(low, lower=1)[0])
    inverse = half + np.tril(half, -1).T
    weights = inverse @ values
    variance = float(values @ weights) / n
    loss = 0.5 * n * np.log(variance) + np.log(np.diag(low)).sum()
    spread = inverse - np.outer(weights, weights) / variance
    base = spread * (factors[:, None] * factors) * (5.0 / 3.0) * (1.0 + scaled) * np.exp(-scaled)
    rows = base.sum(axis=1)
    gradient = np.empty_like(parameters)
    for axis, length in enumerate(covariance.lengths):
        x = places[:, axis] / length
        gradient[axis] = rows @ x**2 - x @ base @ x
    by_scatter = 0.5 * np.diag(spread) * covariance.scatter(places)
    gradient[count], gradient[count + 1 :] = by_scatter.sum(), by_scatter @ (places - 0.5)
    return float(loss), gradient


def _covariance(parameters: Floats, count: int) -> Covariance:
    return Covariance(np.exp(parameters[:count]), float(np.exp(parameters[count])), parameters[count + 1 :])
