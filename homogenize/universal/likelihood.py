"""The covariance that makes the values of scattered cells most likely.

Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, eq. 5.9, with the best variance of the
kernel, and with a scatter whose logarithm is linear in the coordinates.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack
from scipy.optimize import minimize

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.universal.kriging import Covariance, matern

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
