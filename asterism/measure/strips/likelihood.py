"""Maximum likelihood fit in which strips that look flat contribute the bound of their curvature."""

from __future__ import annotations

import numpy as np
from scipy.special import log_ndtr

from asterism.equilibrium.arrays import Floats
from asterism.measure.strips.curvature_model import CurvatureModel, StripData


def flat_terms(mean: Floats, limit: Floats, spread: Floats) -> tuple[Floats, Floats]:
    """First and second derivative with respect to the mean of `-log P(-limit < curvature < limit)`.

    The curvatures (n,) are normally distributed: Tobin's model of censored values (Econometrica 26, 1958).
    """
    # symmetric in the mean: use the side on which the tails are accurate
    side = np.where(mean < 0, -1.0, 1.0)
    above, below = (limit - np.abs(mean)) / spread, (-limit - np.abs(mean)) / spread
    log_share = log_ndtr(above) + np.log1p(-np.exp(np.minimum(log_ndtr(below) - log_ndtr(above), -1e-12)))
    high = np.exp(-0.5 * above**2 - log_share) / np.sqrt(2 * np.pi)
    low = np.exp(-0.5 * below**2 - log_share) / np.sqrt(2 * np.pi)
    first = (high - low) / spread
    second = (above * high - below * low + (high - low) ** 2) / spread**2
    return side * first, np.maximum(second, 0.0)


def solve(model: CurvatureModel, data: StripData, variance: Floats, start: Floats) -> tuple[Floats, Floats]:
    """The most likely parameters for known variances (n,) of the readings, and their covariance.

    Gauss-Newton steps; the covariance is the inverse of the information matrix.
    """
    flat = data.flat
    parameters = start
    for _ in range(60):
        mean, jacobian = model.mean(parameters, data), model.jacobian(parameters, data)
        slope, weight = np.empty(len(mean)), np.empty(len(mean))
        slope[~flat] = (mean - data.curvature)[~flat] / variance[~flat]
        weight[~flat] = 1 / variance[~flat]
        slope[flat], weight[flat] = flat_terms(mean[flat], data.limit[flat], np.sqrt(variance[flat]))
        # scale the columns, because E2/E1 and kappa_bar have different units
        size = np.sqrt((weight[:, None] * jacobian**2).sum(axis=0))
        scaled = jacobian / size
        information = (scaled * weight[:, None]).T @ scaled
        step = np.linalg.solve(information, scaled.T @ slope)
        parameters = parameters - step / size
        if step @ step < 1e-20:
            break
    return parameters, np.linalg.inv(information) / np.outer(size, size)
