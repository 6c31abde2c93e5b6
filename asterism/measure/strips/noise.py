"""The scatter of the readings: from the reading of the boxes, and from strip to strip.

The variance of a reading is `sigma^2 g^2 + tau^2 kappa^2`. Here `sigma` (mm) is the error of a side of a box, `g` the
sensitivity of the curvature to it (`arc.reading_sensitivity`), and `tau` the relative scatter of the curvature from
strip to strip. If the boxes are rounded to marks of a ruler, `sigma` is at least the error of rounding, also if many
readings are equal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from asterism.equilibrium.arrays import Floats, Ints

# largest share of `tau` in the variance: a straight strip has an error of reading too
_MAX_SCATTER_SHARE = 0.99
# smallest errors of a measurement: a part of the curvature, and mm of a side of a box; readings that scatter less were
# rounded, copied or computed
_MIN_CURVATURE_ERROR = 1e-3
_MIN_SIDE_ERROR_MM = 0.01
# readings of a kind that determine its own scatter
MIN_REPEATS = 4


@dataclass(frozen=True)
class ReadingNoise:
    """The noise model: `reading_mm` is sigma (mm), `scatter` is tau (relative)."""

    reading_mm: float
    scatter: float

    def variance(self, sensitivity: Floats, mean: Floats) -> Floats:
        """(n,) 1/mm^2, variances of readings with this sensitivity (1/mm^2) and mean curvature (1/mm)."""
        return np.maximum((self.reading_mm * sensitivity) ** 2 + (self.scatter * mean) ** 2, 1e-24)


def finest_deviation(sensitivity: Floats, mean: Floats) -> Floats:
    """(n,) 1/mm, smallest standard deviation in the test for outliers."""
    return np.hypot(_MIN_CURVATURE_ERROR * mean, _MIN_SIDE_ERROR_MM * sensitivity)


def rounding_deviation(step_mm: Floats) -> Floats:
    """(n,) mm, standard deviation of rounding to steps: a uniform error up to half a step."""
    return np.asarray(step_mm / np.sqrt(12.0))


def shared_rounding(curvature: Floats, kind: Ints, sensitivity: Floats, step_mm: Floats) -> Floats:
    """(n,) 1/mm, standard deviation of the error of rounding that all readings of a kind share.

    The mean does not remove this error. It is large if the readings scatter by less than a mark of the ruler: for a
    normal scatter s and marks at a distance d, the mean deviates by at most `d/pi exp(-2 pi^2 s^2/d^2)`, the first term
    of its Fourier series in the true value (Widrow and Kollar, Quantization Noise, 2008). s is the scatter within the
    kinds without the error of rounding.
    """
    count = np.bincount(kind)
    middle = np.bincount(kind, curvature) / np.maximum(count, 1)
    squares = np.bincount(kind, ((curvature - middle[kind]) / sensitivity) ** 2)
    pooled = squares.sum() / max(int(np.maximum(count - 1, 0).sum()), 1)
    own = np.where(count >= MIN_REPEATS, squares / np.maximum(count - 1, 1), pooled)[kind]
    scatter = np.maximum(own - rounding_deviation(step_mm) ** 2, 0.0)
    off = step_mm / np.pi * np.exp(-2.0 * np.pi**2 * scatter / np.maximum(step_mm, 1e-12) ** 2)
    return np.asarray(off / np.sqrt(2.0) * sensitivity)


def fit_noise(
    residual: Floats,
    jacobian: Floats,
    sensitivity: Floats,
    mean: Floats,
    least_mm: float = 0.0,
    *,
    kind: Ints | None = None,
    times: Floats | None = None,
) -> ReadingNoise:
    """The most likely noise for the residuals (n,) of a fit of jacobian (n, p), n > p; sigma at least `least_mm`.

    Restricted maximum likelihood (Patterson and Thompson, Biometrika 58, 1971) accounts for the fitted parameters.

    Parameters
    ----------
    kind : (n,) number of the kind.
    times : (n,) factor of the variance in the mean of the kind, for the error that the kind shares
        (`asterism.measure.strips.kind_effects`).
    """
    kind = np.arange(len(residual)) if kind is None else kind
    times = np.ones(len(residual)) if times is None else times
    reading = sensitivity**2 / np.mean(sensitivity**2)
    relative = mean**2 / max(float(np.mean(mean**2)), 1e-30)
    free = len(residual) - jacobian.shape[1]

    def minus_log(mix: float) -> float:
        share = (1 - mix) * reading + mix * relative
        information = (jacobian / (share * times)[:, None]).T @ jacobian
        squares = max(_squares(residual, share, kind, times), 1e-30)
        return float(np.sum(np.log(share)) + free * np.log(squares) + np.linalg.slogdet(information)[1])

    minimum = minimize_scalar(minus_log, bounds=(0.0, _MAX_SCATTER_SHARE), method="bounded", options={"xatol": 1e-3})
    mix = min((0.0, float(minimum.x), _MAX_SCATTER_SHARE), key=minus_log)
    share = (1 - mix) * reading + mix * relative
    scale = _squares(residual, share, kind, times) / free
    return ReadingNoise(
        max(float(np.sqrt(scale * (1 - mix) / np.mean(sensitivity**2))), least_mm),
        float(np.sqrt(scale * mix / max(float(np.mean(mean**2)), 1e-30))),
    )


def _squares(residual: Floats, share: Floats, kind: Ints, times: Floats) -> float:
    """Sum of squared residuals over their variances (n,): within the kinds, and of the means of the kinds."""
    weight = np.bincount(kind, 1 / share)
    middle = (np.bincount(kind, residual / share) / np.maximum(weight, 1e-300))[kind]
    return float(np.sum((residual - middle) ** 2 / share) + np.sum(middle**2 / (share * times)))
