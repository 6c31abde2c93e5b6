"""The axes of laws: the sizes of a star, or of the rods of a motif, that tensors are functions of.

Wherever sizes of a star stand in a row, they stand in the order of `AXES`; drawn rods have no length. A new axis is one
entry here, its field in `homogenize.law.material.CampaignPlan`, and its effect on the arms in
`homogenize.cell.unit_cell`.

The first axis is the length of the arms. A star of length 0 has no arms: its cell is the bare fabric, whatever its
other sizes are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.stars import MIN_ARM_MM, THICKNESS_RANGE_MM, WIDTH_RANGE_MM
from asterism.pattern.layout.layout import Layout


@dataclass(frozen=True)
class Axis:
    """One size of a star."""

    name: str  # in sentences
    key: str  # in designs, samples and law files
    nodes_key: str  # in material files
    # smallest and largest value that can be printed. The spacing of the stars limits lengths further.
    limits: tuple[float, float]
    # largest ratio of adjacent nodes in the plan for the stars of one design, and the law is interpolated over the
    # logarithm of the size, which is above 0; None for even steps and the size itself.
    node_ratio: float | None
    # the same for the rods of a motif: bending changes with the cube of the thickness, and membrane with the width.
    rod_ratio: float | None
    # the value at each star of a layout, (S,); its second argument is the number of arms of a whole star.
    measure: Callable[[Layout, int], Floats]

    def coordinate(self, values: Floats) -> Floats:
        """The coordinate that the law is interpolated over, of the same shape as the values."""
        return np.asarray(np.log(values)) if self.node_ratio else values


def _mean_length(layout: Layout, arms: int) -> Floats:
    """(S,) mm, mean length of each star's arms; arms that the outline cuts away count as length 0."""
    return np.asarray(np.bincount(layout.arm_star, layout.arm_length, len(layout.centres)) / arms)


def _mean_along_arms(layout: Layout, arms: int, ends: Floats) -> Floats:
    """(S,) mean of a size that is given at both ends of each arm (R, 2), weighted by the length of the arms."""
    star = layout.arm_star
    share = layout.arm_length / (arms * _mean_length(layout, arms)[star])
    return np.asarray(np.bincount(star, share * ends.mean(axis=1), len(layout.centres)))


LENGTH = Axis(
    name="length",
    key="length_mm",
    nodes_key="lengths_mm",
    limits=(MIN_ARM_MM, math.inf),
    node_ratio=None,
    rod_ratio=None,
    measure=_mean_length,
)


AXES = (
    LENGTH,
    Axis(
        name="thickness",
        key="thickness_mm",
        nodes_key="thicknesses_mm",
        limits=THICKNESS_RANGE_MM,
        node_ratio=1.2,
        rod_ratio=1.12,
        measure=lambda layout, arms: _mean_along_arms(layout, arms, layout.arm_thickness),
    ),
    Axis(
        name="width",
        key="width_mm",
        nodes_key="widths_mm",
        limits=WIDTH_RANGE_MM,
        node_ratio=1.3,
        rod_ratio=1.26,
        measure=lambda layout, arms: _mean_along_arms(layout, arms, layout.arm_width),
    ),
)
AXIS_OF = {axis.key: axis for axis in AXES}


def law_coordinates(layout: Layout, arms: int) -> Floats:
    """(S, A) sizes of the stars of a layout, one column for each of `AXES`.

    Lengths are means over the arms, and arms that the outline cuts away count as length 0. The other sizes are means
    along the arms.
    """
    return np.column_stack([axis.measure(layout, arms) for axis in AXES])


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
