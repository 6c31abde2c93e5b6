"""Sizes that vary along a line."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Point
from asterism.pattern.design.sizing.profile import GradientProfile

MIN_GRADIENT_LENGTH_MM = 1e-6


class LinearProfile(GradientProfile):
    """From the value at `start_mm` to the value at `end_mm`, constant across."""

    key: ClassVar[str] = "linear"
    profile: Literal["linear"]
    start_mm: Point
    end_mm: Point

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        if np.linalg.norm(np.subtract(self.end_mm, self.start_mm)) < MIN_GRADIENT_LENGTH_MM:
            raise DesignError("end_mm", "must differ from start_mm", self.end_mm)
        return self

    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm."""
        way = np.subtract(self.end_mm, self.start_mm)
        return np.asarray((points - np.asarray(self.start_mm)) @ way / (way @ way))
