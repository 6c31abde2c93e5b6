"""Distance of two shapes of one design, for every symmetry of the design."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pattern.geometry.arrays import Floats
from pattern.geometry.rigid_fit import rms_distance
from pattern.layout.symmetries import Symmetry


def symmetric_distances(first: Floats, second: Floats, symmetries: Sequence[Symmetry]) -> Floats:
    """(n,) mm, rms distance of two shapes after the best rigid motion, for each of n symmetries.

    Parameters
    ----------
    first, second : (S, 3) mm, star centres of the two shapes.
    symmetries : each stands for the image `x'(p) = Q x(turn p + shift)` of the second shape, see `Symmetry`.
    """
    return np.array([rms_distance(second[each.star], first, each.mirrors) for each in symmetries])
