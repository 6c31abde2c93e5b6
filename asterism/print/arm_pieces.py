"""The plastic of a layout as straight strips, each of one height: what is united, drawn and scripted."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pattern.design.rounding import Rounding
from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout


@dataclass(frozen=True)
class ArmPiece:
    """Part of an arm, or all of it.

    Attributes
    ----------
    star : its number in the layout.
    direction : (2,) unit vector from the star's centre.
    begin_mm, end_mm : distances from the centre.
    begin_width_mm, end_width_mm : widths there, linear between.
    height_mm : to which it is printed.
    """

    star: int
    direction: Floats
    begin_mm: float
    end_mm: float
    begin_width_mm: float
    end_width_mm: float
    height_mm: float

    def corners(self, centre: Floats) -> Floats:
        """(4, 2) mm, counterclockwise."""
        side = np.array([-self.direction[1], self.direction[0]])
        begin, end = centre + self.begin_mm * self.direction, centre + self.end_mm * self.direction
        a, b = self.begin_width_mm / 2 * side, self.end_width_mm / 2 * side
        return np.array([begin - a, end - b, end + b, begin + a])


def arm_pieces(plan: Layout, rounding: Rounding) -> list[ArmPiece]:
    """The strips of all arms, arm by arm from the centre outwards.

    An arm is the strip that the model computes with, from the star's centre to the tip, cut off straight. An arm
    whose thickness varies along it is printed in steps of a layer.
    """
    result: list[ArmPiece] = []
    along = plan.arm_tip - plan.centres[plan.arm_star]
    for arm, (star, length) in enumerate(zip(plan.arm_star, plan.arm_length, strict=True)):
        heights, ends = _height_steps(plan.arm_thickness[arm], rounding)
        widths = np.interp(ends, [0.0, 1.0], plan.arm_width[arm])
        for k, height in enumerate(heights):
            begin, end = ends[k] * length, ends[k + 1] * length
            result.append(ArmPiece(int(star), along[arm] / length, begin, end, widths[k], widths[k + 1], float(height)))
    return result


def _height_steps(thickness: Floats, rounding: Rounding) -> tuple[Floats, Floats]:
    """Heights along an arm, and where each begins and ends as fractions of its length."""
    first, last = (float(h) for h in thickness)
    if first == last:
        return np.array([first]), np.array([0.0, 1.0])
    low, high = np.sort(rounding.layers(thickness))
    # the next layer begins where the arm is halfway between two: cut tips are no whole number of layers
    layers = np.arange(np.floor(low), np.ceil(high)) + 0.5
    changes = (rounding.height(layers) - first) / (last - first)
    ends = np.unique(np.clip([0.0, *changes, 1.0], 0.0, 1.0))
    middles = (ends[:-1] + ends[1:]) / 2
    return rounding.thickness(first + middles * (last - first)), ends
