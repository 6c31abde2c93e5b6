"""The base of all sizing profiles."""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import Field

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.section import Number, Section

DistanceMm = Annotated[Number, Field(gt=0, le=1e4)]
Power = Annotated[Number, Field(gt=0, le=100)]


class Profile(Section):
    """A quantity that varies over the sheet.

    A new profile is a subclass in `PROFILES`. A design file selects it by its key.

    Attributes
    ----------
    key : name of the profile. In a design file, a table belongs to this profile if it has `profile = "<key>"`.
    is_marked_by_key : a table belongs to this profile if it has the key `<key>` itself, as `{ formula = "..." }`.
    """

    key: ClassVar[str]
    is_marked_by_key: ClassVar[bool] = False

    @classmethod
    def describes(cls, table: dict[Any, Any]) -> bool:
        """Whether a table of the design file belongs to this profile."""
        return cls.key in table if cls.is_marked_by_key else table.get("profile") == cls.key

    @abstractmethod
    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm."""


class GradientProfile(Profile):
    """Goes from `start` (in the file: `from`) to `end` (`to`), and is constant beyond."""

    start: Number = Field(alias="from")
    end: Number = Field(alias="to")
    power: Power = 1.0

    @abstractmethod
    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm; below 0 or above 1 beyond them."""

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm; `power` bends the profile."""
        return np.asarray(self.start + (self.end - self.start) * np.clip(self.fraction(points), 0, 1) ** self.power)
