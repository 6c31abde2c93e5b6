"""The bumps of the stars, laid on the smooth surface of the shell.

The law gives each star the heights of its cell over the mean surface, as amplitudes of a few waves of the lattice
(`homogenize.relief`): those of the flat cell, and how they change as the sheet curls. Amplitudes are shared between
stars as everything else is, so that the relief has no jumps and ends on the bare rim. A printed point moves by its
height along the shell's normal.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from asterism.previewing.star_values import StarValues
from pattern.layout import Floats

# curvatures over a star's own up to which its relief was seen to follow them: bent the other way, and a dome
MOST = (-1.0, 2.0)


def relief_heights(waves: Floats, values: StarValues, weights: sp.csr_matrix, curvature: Floats) -> Floats:
    """(n,) mm over the shell.

    Parameters
    ----------
    waves : (n, W) the law's waves at the points.
    weights : (n, S) share of each star at the points.
    curvature : (n,) 1/mm, sum of the shell's principal curvatures, positive where the plastic side is convex.
    """
    flat, more = np.moveaxis(_shared(weights, values.relief), 1, 0)
    own = np.abs(_shared(weights, values.value["kappa"]))
    bent = np.clip(curvature, MOST[0] * own, MOST[1] * own)
    return np.einsum("nw,nw->n", flat + bent[:, None] * more, waves)


def _shared(weights: sp.csr_matrix, values: Floats) -> Floats:
    """(n, ...) of values (S + 1, ...), the last one the bare fabric's."""
    bare = values[-1]
    more = (values[:-1] - bare).reshape(len(values) - 1, -1)
    return bare + (weights @ more).reshape(-1, *values.shape[1:])
