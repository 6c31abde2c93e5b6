"""How far readings scatter: by the reading of the boxes, and from strip to strip.

The variance of a reading is `sigma^2 g^2 + tau^2 kappa^2`: `sigma` mm is the error of a side of a box, `g` what it does
to the curvature (`arc.reading_sensitivity`), and `tau` the part by which curvatures differ from strip to strip. Boxes
that were rounded to a ruler's marks are not read better than that, though many read the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from pattern.geometry.arrays import Floats, Ints

# a strip that should be straight has some error of reading, whatever the others say
_MOST_MIX = 0.99
# nobody measures a curvature better than by this part of it, nor a box better than by a hundredth of a millimetre: what
# scatters less was rounded, copied or computed
_FINEST_PART, _FINEST_MM = 1e-3, 0.01
# readings of a kind that tell its own scatter
MIN_REPEATS = 4


@dataclass(frozen=True)
class ReadingNoise:
    """Attributes: `reading_mm` is sigma, `scatter` is tau, a part of one."""

    reading_mm: float
    scatter: float

    def variance(self, sensitivity: Floats, mean: Floats) -> Floats:
        """(n,) 1/mm^2."""
        return np.maximum((self.reading_mm * sensitivity) ** 2 + (self.scatter * mean) ** 2, 1e-24)


def finest_deviation(sensitivity: Floats, mean: Floats) -> Floats:
    """(n,) 1/mm, the least standard deviation by which readings are called too far from others."""
    return np.hypot(_FINEST_PART * mean, _FINEST_MM * sensitivity)


def rounding_deviation(step_mm: Floats) -> Floats:
    """(n,) mm, standard deviation of what was rounded to steps: errors up to half a step are all as likely."""
    return np.asarray(step_mm / np.sqrt(12.0))


def shared_rounding(curvature: Floats, kind: Ints, sensitivity: Floats, step_mm: Floats) -> Floats:
    """(n,) 1/mm, standard deviation of what rounding does alike to all readings of a kind, which should be equal.

    No mean takes it away. It is much where they scatter by less than a mark of the ruler: for a normal scatter s and
    marks d apart the mean is off by `d/pi exp(-2 pi^2 s^2/d^2)` at most, the first term of its Fourier series in the
    true value (Widrow and Kollar, Quantization Noise, 2008). s is what is seen within the kinds, without what rounding
    adds to it; a misfit between kinds does not count.
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

    Restricted maximum likelihood (Patterson and Thompson, Biometrika 58, 1971), which allows for the fitted parameters.

    Parameters
    ----------
    kind, times : (n,) readings of a kind, and how much larger their variance counts in the mean of their kind for what
        they have in common (`asterism.measure.strips.kind_effects`).
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

    found = minimize_scalar(minus_log, bounds=(0.0, _MOST_MIX), method="bounded", options={"xatol": 1e-3})
    mix = min((0.0, float(found.x), _MOST_MIX), key=minus_log)
    share = (1 - mix) * reading + mix * relative
    scale = _squares(residual, share, kind, times) / free
    return ReadingNoise(
        max(float(np.sqrt(scale * (1 - mix) / np.mean(sensitivity**2))), least_mm),
        float(np.sqrt(scale * mix / max(float(np.mean(mean**2)), 1e-30))),
    )


def _squares(residual: Floats, share: Floats, kind: Ints, times: Floats) -> float:
    """Squares of residuals over their variances (n,): within kinds, and of the means of kinds."""
    weight = np.bincount(kind, 1 / share)
    middle = (np.bincount(kind, residual / share) / np.maximum(weight, 1e-300))[kind]
    return float(np.sum((residual - middle) ** 2 / share) + np.sum(middle**2 / (share * times)))
