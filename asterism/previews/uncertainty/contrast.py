"""How far a free sheet follows what the law says of unequal stars.

What large and small stars contract by differently bends the sheet: it cannot lie flat with both. The law's contractions
are wrong by little, but where they are wrong by more for larger stars, the whole sheet answers. How far it would go for
an error of one in one tells sheets that hang on this from those that do not.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.search.linear_response import rms_response

if TYPE_CHECKING:
    from asterism.previews.session import Preview

ALIKE = 1e-9  # of a size: stars that differ by less are equal
WRONG = 1e-3  # part of a deviation from the mean by which contractions are tried otherwise


def contrast(preview: Preview, factor: Factor) -> float:
    """mm, rms over the sheet, by which its equilibrium would be off for errors that grow with the stars.

    For each size - length, thickness, width - contractions that are wrong by the relative deviation of a star's from
    the mean, and the root of the sum of squares of the answers. The factor holds the Hessian at the equilibrium.
    """
    sizes = preview.values.sizes
    mean = sizes.mean(axis=0)
    unequal = np.flatnonzero(np.ptp(sizes, axis=0) > ALIKE * mean)
    return math.hypot(*(_answer(preview, factor, sizes[:, size] / mean[size] - 1.0) for size in unequal))


def _answer(preview: Preview, factor: Factor, errors: Floats) -> float:
    """mm, rms: for contractions of the stars that are wrong by parts (S,)."""
    shell, value = preview.shell, preview.values.value
    wrong = np.append(1.0 + WRONG * errors, 1.0)
    others = replace(preview.values, value=value | {name: wrong * value[name] for name in ("lam", "lam_n")})
    return rms_response(shell, preview.equilibrium.x, factor, preview.sheet.fields(others)) / WRONG
