"""The arms of a layout as straight pieces of one height, for solids, drawings and scripts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.layout.layout import Layout


@dataclass(frozen=True)
class ArmPiece:
    """A straight piece of an arm with one height.

    Attributes
    ----------
    star : number of the star in the layout.
    direction : (2,) unit vector from the centre of the star.
    begin_mm, end_mm : distances of both ends from the centre.
    begin_width_mm, end_width_mm : widths at both ends, linear between them.
    height_mm : printed height.
    """

    star: int
    direction: Floats
    begin_mm: float
    end_mm: float
    begin_width_mm: float
    end_width_mm: float
    height_mm: float

    def corners(self, centre: Floats) -> Floats:
        """(4, 2) mm, corners, counterclockwise."""
        side = np.array([-self.direction[1], self.direction[0]])
        begin, end = centre + self.begin_mm * self.direction, centre + self.end_mm * self.direction
        a, b = self.begin_width_mm / 2 * side, self.end_width_mm / 2 * side
        return np.array([begin - a, end - b, end + b, begin + a])


def arm_pieces(plan: Layout, rounding: Rounding) -> list[ArmPiece]:
    """The pieces of all arms, arm by arm from the centre outwards.

    An arm is the strip of the model, from the centre of the star to the tip, with a straight end. An arm of varying
    thickness is printed in steps of one layer.
    """
    result: list[ArmPiece] = []
    along = plan.arm_tip - plan.centres[plan.arm_star]
    for arm, (star, length) in enumerate(zip(plan.arm_star, plan.arm_length, strict=True)):
        heights, ends = height_steps(plan.arm_thickness[arm], rounding)
        widths = np.interp(ends, [0.0, 1.0], plan.arm_width[arm])
        for k, height in enumerate(heights):
            begin, end = ends[k] * length, ends[k + 1] * length
            result.append(ArmPiece(int(star), along[arm] / length, begin, end, widths[k], widths[k + 1], float(height)))
    return result


def height_steps(thickness: Floats, rounding: Rounding) -> tuple[Floats, Floats]:
    """Heights along an arm, each with its begin and end as fractions of the arm's length."""
    first, last = (float(h) for h in thickness)
    if first == last:
        return np.array([first]), np.array([0.0, 1.0])
    low, high = np.sort(rounding.layers(thickness))
    # a layer begins halfway between two heights; the height of a cut tip may lie between layers
    layers = np.arange(np.floor(low), np.ceil(high)) + 0.5
    changes = (rounding.height(layers) - first) / (last - first)
    ends = np.unique(np.clip([0.0, *changes, 1.0], 0.0, 1.0))
    middles = (ends[:-1] + ends[1:]) / 2
    return rounding.thickness(first + middles * (last - first)), ends
