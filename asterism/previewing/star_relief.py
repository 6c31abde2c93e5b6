"""The bumps of the stars, laid on the smooth surface of the shell.

The law gives each star the heights of its cell over the mean surface, as amplitudes of a few waves of the lattice
(`homogenize.relief`). Amplitudes are shared between stars as everything else is, so that the relief has no jumps and
ends on the bare rim. A printed point moves by its height along the shell's normal.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from homogenize.relief import Waves
from pattern.layout import Floats


def relief_heights(
    waves: Waves, amplitudes: Floats, weights: sp.csr_matrix, points: Floats, lattice_origin: Floats
) -> Floats:
    """(n,) mm over the shell at printed points (n, 2).

    Parameters
    ----------
    amplitudes : (S + 1, W) mm of the stars and the bare fabric.
    weights : (n, S) share of each star at the points.
    lattice_origin : (2,) mm, the place of a star.
    """
    shared = amplitudes[-1] + weights @ (amplitudes[:-1] - amplitudes[-1])
    return np.einsum("nw,nw->n", shared, waves(points - lattice_origin))
