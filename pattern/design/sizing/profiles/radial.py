"""Sizes that vary with the distance from a centre."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.section import Point
from asterism.pattern.design.sizing.profile import DistanceMm, GradientProfile


class RadialProfile(GradientProfile):
    """From the value at `centre_mm` to the value at the distance `over_mm` and beyond.

    Examples
    --------
    >>> radial = RadialProfile.model_validate({"profile": "radial", "from": 10, "to": 4, "over_mm": 30})
    >>> radial.at(np.array([[0.0, 0.0], [15.0, 0.0], [0.0, 60.0]])).tolist()
    [10.0, 7.0, 4.0]
    """

    key: ClassVar[str] = "radial"
    profile: Literal["radial"]
    over_mm: DistanceMm
    centre_mm: Point = (0.0, 0.0)

    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm."""
        return np.asarray(np.linalg.norm(points - np.asarray(self.centre_mm), axis=1) / self.over_mm)
