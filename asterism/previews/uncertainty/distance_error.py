"""Estimated error of a preview: rms distance to the exact shape, in % of the diameter.

The preview is a minimum of an energy that is wrong. Its error is a sum of independent normal errors:

- **Energy.** The energy is uncertain by the share u = `energy_uncertainty` of the energy E at stake, in each mode of
  the sheet. A mode of stiffness k would take the energy E up to the amplitude `a = sqrt(2 E/k)`
  (`asterism.previews.search.near_zero_modes`). If the energy's error changes by u E over that amplitude, it is a force
  `u E/a`, and moves the mode by `u E/(a k) = u a/2`. So the covariance of the shape is `u^2 E/2` times the inverse of
  the Hessian.
- **Stiffnesses.** Membrane, bending, sixfold term and Gaussian modulus have the relative standard deviation
  s = `stiffness_uncertainty`. With the linear response r_p of the sheet to each
  (`fem.search.linear_response`), they move it by s r_p.
- **Narrow sheets.** Supports that hold a sheet narrower than its natural size, by the share 1 - q of it, let it buckle,
  and the exact sheet may buckle at other places: n (1 - q) with n = `buckling_share`.
- **Other forms.** A minimum that the search met, d away and a share g of the energy higher, is the lower one with the
  probability `P = erfc(g/(sqrt(2) u))/2`, by the same u.

With the error m = `mesh_error_percent` of the exact shape itself, and z = `COVERAGE`,

    error^2 = m^2 + z^2 (u^2/4 sum a_i^2 + s^2 sum r_p^2 + n^2 (1 - q)^2 + max P_j d_j^2).

So nine of ten exact shapes are nearer than estimated. u, s and n are fitted together.
"""

from __future__ import annotations

import math

import numpy as np

from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.uncertainty.error_sources import ErrorSources

# standard deviations of a normal error within which nine of ten are
COVERAGE = 1.645


def distance_error_percent(sources: ErrorSources, model: PreviewModel = PREVIEW_MODEL) -> float | None:
    """The estimated error in % of the diameter; None with fewer than two computed modes.

    Examples
    --------
    >>> calm = ErrorSources(100.0, np.array([6.0, 4.0, 3.0]))
    >>> narrow = ErrorSources(100.0, np.array([6.0, 4.0, 3.0]), size_ratio=0.8)
    >>> distance_error_percent(narrow) > 5.0 * distance_error_percent(calm)
    True
    """
    if len(sources.amplitudes_percent) < 2:
        return None
    return math.hypot(model.mesh_error_percent, COVERAGE * math.hypot(*distance_parts(sources, model).values()))


def distance_parts(sources: ErrorSources, model: PreviewModel = PREVIEW_MODEL) -> dict[str, float]:
    """Standard deviations in % of the diameter: `soft`, `stiffness`, `narrow` and `form`."""
    forms = [math.sqrt(probability_lower(o.gap, model)) * o.distance_percent for o in sources.other_forms]
    return {
        "soft": 0.5 * model.energy_uncertainty * float(np.linalg.norm(sources.amplitudes_percent)),
        "stiffness": model.stiffness_uncertainty * float(np.linalg.norm(sources.stiffness_percent)),
        "narrow": 100.0 * model.buckling_share * sources.narrowing,
        "form": max(forms, default=0.0),
    }


def probability_lower(gap: float, model: PreviewModel = PREVIEW_MODEL) -> float:
    """Probability that a form whose energy is higher by the share `gap` of the energy at stake is the lower one.

    Examples
    --------
    >>> round(probability_lower(0.0), 2), round(probability_lower(PREVIEW_MODEL.energy_uncertainty), 2)
    (0.5, 0.16)
    """
    return 0.5 * math.erfc(gap / (math.sqrt(2.0) * model.energy_uncertainty))
