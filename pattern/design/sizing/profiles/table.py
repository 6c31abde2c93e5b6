"""Sizes from a table over the distance from a centre."""

from __future__ import annotations

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Flag, Number, Point
from asterism.pattern.design.sizing.profile import Profile

MIN_TABLE_STEP_MM = 1e-6


class TableProfile(Profile):
    """Values over the distance from `centre_mm`, linear between the entries, constant beyond the ends.

    `smooth` puts a monotone cubic through the entries instead. It never exceeds their range.

    Examples
    --------
    >>> table = TableProfile(profile="table", distance_mm=(0.0, 10.0), values=(2.0, 4.0))
    >>> table.at(np.array([[5.0, 0.0], [0.0, 50.0]])).tolist()
    [3.0, 4.0]
    """

    key: ClassVar[str] = "table"
    profile: Literal["table"]
    distance_mm: tuple[Number, ...] = Field(min_length=2, max_length=1000)
    values: tuple[Number, ...] = Field(min_length=2, max_length=1000)
    centre_mm: Point = (0.0, 0.0)
    smooth: Flag = False

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        if len(self.values) != len(self.distance_mm):
            raise DesignError("values", f"must have {len(self.distance_mm)} entries, one a distance", self.values)
        if not np.all(np.diff(self.distance_mm) >= MIN_TABLE_STEP_MM):
            allowed = "must increase from entry to entry, by 1e-6 or more"
            raise DesignError("distance_mm", allowed, self.distance_mm)
        return self

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm."""
        distance = np.linalg.norm(points - np.asarray(self.centre_mm), axis=1)
        if self.smooth:
            from scipy.interpolate import PchipInterpolator  # slow to import, rarely used

            inside = np.clip(distance, self.distance_mm[0], self.distance_mm[-1])
            return np.asarray(PchipInterpolator(self.distance_mm, self.values)(inside))
        return np.asarray(np.interp(distance, self.distance_mm, self.values))
