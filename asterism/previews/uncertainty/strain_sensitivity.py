"""Sensitivity of a free sheet to a strain error that depends on the size of the stars.

Large and small stars contract differently, and that bends the sheet: it cannot lie flat with both. The law's
contractions have small errors. If these errors grow with the size of the star, the whole sheet responds. For an error

    lam_s -> lam_s (1 + e (size_s / mean size - 1))

of each star s, the linear response of the sheet is e times a displacement; its rms is the sensitivity for that size.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from asterism.previews.state import StarState
from equilibrium.arrays import Floats
from fem.search.linear_response import rms_response

# stars are equal if the relative range of their sizes is at most this
EQUAL_SIZE = 1e-9
# value of e for which the response is computed
TRIED_ERROR = 1e-3


def strain_sensitivity(state: StarState) -> float:
    """mm, rms over the sheet, per unit of e; the root of the sum of squares over length, thickness and width.

    The factor holds the Hessian at the equilibrium. Sheets of equal stars have none.
    """
    sizes = state.values.sizes
    mean = sizes.mean(axis=0)
    unequal = np.flatnonzero(np.ptp(sizes, axis=0) > EQUAL_SIZE * mean)
    return math.hypot(*(_response(state, sizes[:, size] / mean[size] - 1.0) for size in unequal))


def _response(state: StarState, errors: Floats) -> float:
    """mm, rms per unit of e, for relative errors e * errors (S,) of the contractions."""
    factors = np.append(1.0 + TRIED_ERROR * errors, 1.0)
    value = state.values.value
    changed = replace(state.values, value=value | {name: factors * value[name] for name in ("lam", "lam_n")})
    fields = state.sheet.fields(changed)
    return rms_response(state.shell, state.equilibrium.x, state.factor, fields) / TRIED_ERROR
