"""Estimated error of a preview: rms distance to the exact shape, in % of the diameter.

With a the root of the sum of squares of the amplitudes a_i of the near-zero modes
(`asterism.previews.search.near_zero_modes`), and c the sensitivity to size-dependent strain error
(`asterism.previews.uncertainty.strain_sensitivity`), the estimate is

    error^2 = floor^2 + share^2 (a^2 + c^2) + max P_j d_j^2.

- **Share.** The law's energies and contractions are wrong by a small part, so that the shape is off by a small share of
  a and of c: `amplitude_share`, one for all sheets.
- **Other forms.** A minimum that the search met, d % away and a share g of the energy higher, is the lower one with the
  probability `P = erfc(g/(sqrt(2) u))/2` if the law's energies are uncertain by the share u, normally distributed.

`python -m benchmarks.accuracy.amplitude_share` chooses the share and states how many exact shapes are as near as
estimated; `python -m benchmarks.accuracy.expectation` compares the estimate with exact shapes. Over many designs it is
a root mean square, and most previews are closer.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.uncertainty.other_forms import OtherForm
from equilibrium.arrays import Floats


def distance_error_percent(
    amplitudes: Floats,
    others: Sequence[OtherForm] = (),
    sensitivity_percent: float = 0.0,
    model: PreviewModel = PREVIEW_MODEL,
) -> float | None:
    """The estimated error in % of the diameter; None without two amplitudes.

    Parameters
    ----------
    amplitudes : (k,) %, the largest first.
    sensitivity_percent : to size-dependent strain error, in % of the diameter.

    Examples
    --------
    >>> import numpy as np
    >>> distance_error_percent(np.array([6.0, 4.0, 3.0])).__round__(2)
    0.69
    """
    if len(amplitudes) < 2:
        return None
    soft = model.amplitude_share * math.hypot(*amplitudes, sensitivity_percent)
    form = max((math.sqrt(probability_lower(o.gap, model)) * o.distance_percent for o in others), default=0.0)
    return math.hypot(model.floor_percent, soft, form)


def probability_lower(gap: float, model: PreviewModel = PREVIEW_MODEL) -> float:
    """Probability that a form whose energy is higher by the share `gap` of the energy at stake is the lower one.

    Examples
    --------
    >>> probability_lower(0.0), round(probability_lower(0.05), 2), round(probability_lower(0.3), 3)
    (0.5, 0.31, 0.001)
    """
    return 0.5 * math.erfc(gap / (math.sqrt(2.0) * model.energy_uncertainty))
