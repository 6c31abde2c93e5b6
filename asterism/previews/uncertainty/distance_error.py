"""Estimated error of a preview: rms distance to the exact shape, in % of the diameter.

With a the root of the sum of squares of the amplitudes a_i of the near-zero modes
(`asterism.previews.search.near_zero_modes`), the estimate is

    error^2 = floor^2 + (share a)^2 + (curls)^2 + (buckling)^2 + (unequal stars)^2 + max(form^2, P_j d_j^2).

- **Amplitudes.** The law's energies are wrong by a small part, so that the shape is off by a small share of a:
  `amplitude_share`. It is one for all sheets: shares by symmetry and support of their own announce no further miss.
- **Curls.** A free sheet whose stars curl within their own spacing is not smooth: `other_form_percent` times the share
  of these stars.
- **Buckling.** A supported sheet that is much narrower than its natural size buckles, and the law cannot tell where.
- **Unequal stars.** `size_strain_share` times the sensitivity to size-dependent strain error
  (`asterism.previews.uncertainty.strain_sensitivity`), and at most `other_form_percent`.
- **Other forms.** Two near-zero modes make another form likely, with a weight r^n/(1 + r^n), r being the second
  amplitude over its limit. A minimum that the search met, d % away and a share g of the energy higher, is the lower one
  with the probability `P = erfc(g/(sqrt(2) u))/2` if the law's energies are uncertain by the share u, normally
  distributed.

`python -m benchmarks.accuracy.expectation` compares the estimate with exact shapes; over many designs it is a root mean
square, and most previews are closer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.search.near_zero_modes import second_amplitude_limit
from asterism.previews.uncertainty.other_forms import OtherForm
from equilibrium.arrays import Floats


def distance_error_percent(
    amplitudes: Floats,
    others: Sequence[OtherForm] = (),
    is_supported: bool = False,
    tight_share: float = 0.0,
    size_ratio: float = 1.0,
    sensitivity_percent: float = 0.0,
    model: PreviewModel = PREVIEW_MODEL,
) -> float | None:
    """The estimated error in % of the diameter; None without two amplitudes.

    Parameters
    ----------
    amplitudes : (k,) %, the largest first.
    tight_share : of the stars that are not scale-separated.
    size_ratio : size that the supports allow over the natural size.
    sensitivity_percent : to size-dependent strain error, in % of the diameter.

    Examples
    --------
    >>> distance_error_percent(np.array([6.0, 4.0, 3.0]), is_supported=True, size_ratio=np.inf).__round__(2)
    0.56
    """
    if len(amplitudes) < 2:
        return None
    curls = 0.0 if is_supported else model.other_form_percent * tight_share
    soft = model.amplitude_share * float(np.linalg.norm(amplitudes))
    buckling = model.buckling_percent * buckling_weight(size_ratio, model)
    near = math.hypot(model.floor_percent, soft, curls, buckling, unequal_stars_percent(sensitivity_percent, model))
    ratio = (float(amplitudes[1]) / second_amplitude_limit(is_supported, model)) ** model.other_form_sharpness
    form = max(
        [
            model.other_form_percent * ratio / (1.0 + ratio),
            *(math.sqrt(probability_lower(o.gap, model)) * o.distance_percent for o in others),
        ]
    )
    return float(np.hypot(near, form))


def unequal_stars_percent(sensitivity_percent: float, model: PreviewModel = PREVIEW_MODEL) -> float:
    """%, the error due to unequal stars; where the sheet is about to fold, that of another form at most."""
    return min(model.size_strain_share * sensitivity_percent, model.other_form_percent)


def buckling_weight(size_ratio: float, model: PreviewModel = PREVIEW_MODEL) -> float:
    """From 0 to 1, how likely a sheet buckles whose supports allow this ratio of its natural size.

    Examples
    --------
    >>> buckling_weight(1.0), buckling_weight(0.8)
    (0.0, 1.0)
    """
    start, full = model.buckling_ratio_start, model.buckling_ratio_full
    return min(max((start - size_ratio) / (start - full), 0.0), 1.0)


def probability_lower(gap: float, model: PreviewModel = PREVIEW_MODEL) -> float:
    """Probability that a form whose energy is higher by the share `gap` of the energy at stake is the lower one.

    Examples
    --------
    >>> probability_lower(0.0), round(probability_lower(0.05), 2), round(probability_lower(0.3), 3)
    (0.5, 0.31, 0.001)
    """
    return 0.5 * math.erfc(gap / (math.sqrt(2.0) * model.energy_uncertainty))
