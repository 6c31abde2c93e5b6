"""The axes of laws: the sizes of a star, or of the rods of a motif, that tensors are functions of.

They are `pattern.design.stars.STAR_SIZES`, and for the rods of a motif `ROD_SIZES`. The first axis is the length of the
arms. A star of length 0 has no arms: its cell is the bare fabric, whatever its other sizes are.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import Layout


def _mean_length(layout: Layout, arms: int) -> Floats:
    """(S,) mm, mean length of each star's arms; arms that the outline cuts away count as length 0."""
    return np.asarray(np.bincount(layout.arm_star, layout.arm_length, len(layout.centres)) / arms)


def law_coordinates(layout: Layout, arms: int) -> Floats:
    """(S, L) sizes of the stars of a layout, one column for each of `STAR_SIZES`; whole stars have so many arms.

    Lengths are means over the arms, and arms that the outline cuts away count as length 0. The other sizes are means
    along the arms.
    """
    star, length = layout.arm_star, _mean_length(layout, arms)
    share = layout.arm_length / (arms * length[star])
    along = (layout.arm_sections.mean(axis=1) * share[:, None]).T
    return np.column_stack([length, *(np.bincount(star, each, len(length)) for each in along)])


def min_length(lengths_mm: Iterable[float], spacing_mm: float) -> float:
    """mm, the shortest arms that a law from cells of these lengths covers; 0 if it covers all.

    >>> min_length([0.0, 3.4, 6.0], 17.3), min_length([0.0, 3.6, 6.0], 17.3)
    (0.0, 3.6)
    """
    first = min((float(length) for length in lengths_mm if length > 0), default=0.0)
    # Up to arms of this length a sheet departs so smoothly from bare fabric that a curve from there to the first cell
    # gives all lengths between: the paper's law without its shorter cells keeps contractions within 0.5 % there for
    # thicknesses from 0.3 mm. Longer arms begin to curl their sheet.
    return first if first > 0.2 * spacing_mm else 0.0
