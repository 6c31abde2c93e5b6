"""The conformal flattening with the smallest ratio of scale factors.

The logarithm u of the scale factor is determined by its values at the border. The smallest range `max u - min u` over
all border values is a linear programme: the border values are a Fourier series over the length of the border, and
each of its terms changes u by a harmonic function.

For a surface whose Gauss curvature has one sign, constant border values are the best (Chebyshev and Grave): a
harmonic function added to u increases its range.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog

from asterism.equilibrium.arrays import Floats
from asterism.fitting.flattening.boundary_first import Flattener

# number of Fourier terms: cosines and sines of 1 to 12 waves around the border
FOURIER_TERMS = 24
# inner vertices that the programme bounds; u is smooth, so that a selection is enough
MAX_BOUNDED_VERTICES = 1500


def least_ratio_border(flattener: Flattener, terms: int = FOURIER_TERMS) -> Floats:
    """(B,) logarithms of the scale factor at the border for the smallest ratio of scale factors.

    Parameters
    ----------
    terms : number of Fourier terms of the border values.
    """
    disk = flattener.disk
    around = np.cumsum(flattener.border_lengths) - flattener.border_lengths
    angle = 2.0 * np.pi * around / flattener.border_lengths.sum()
    waves = np.arange(1, terms // 2 + 1)
    series = np.concatenate([np.cos(angle[:, None] * waves), np.sin(angle[:, None] * waves)], axis=1)
    start = flattener.log_scale(np.zeros(len(disk.border)))
    change = flattener.harmonic(series)
    inner = disk.inner[:: max(len(disk.inner) // MAX_BOUNDED_VERTICES, 1)]
    rows = np.concatenate([disk.border, inner])
    ones = np.ones((len(rows), 1))
    zeros = np.zeros((len(rows), 1))
    # unknowns: coefficients, upper and lower bound of u
    above = np.hstack([change[rows], -ones, zeros])
    below = np.hstack([-change[rows], zeros, ones])
    cost = np.concatenate([np.zeros(series.shape[1]), [1.0, -1.0]])
    solution = linprog(
        cost,
        A_ub=np.vstack([above, below]),
        b_ub=np.concatenate([-start[rows], start[rows]]),
        bounds=(None, None),
        method="highs",
    )
    if solution.status != 0:
        return np.zeros(len(disk.border))
    return np.asarray(series @ solution.x[: series.shape[1]])
