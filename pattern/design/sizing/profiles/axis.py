"""Sizes that vary with the distance from a centre line."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.section import Point
from asterism.pattern.design.sizing.profile import DistanceMm, GradientProfile


class AxisProfile(GradientProfile):
    """From the value on the centre line to the value at `over_mm` on both sides of it.

    `axis = "x"` varies along x: the distance is |x - centre x|.
    """

    key: ClassVar[str] = "axis"
    profile: Literal["axis"]
    axis: Literal["x", "y"]
    over_mm: DistanceMm
    centre_mm: Point = (0.0, 0.0)

    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm."""
        component = "xy".index(self.axis)
        return np.asarray(np.abs(points[:, component] - self.centre_mm[component]) / self.over_mm)
