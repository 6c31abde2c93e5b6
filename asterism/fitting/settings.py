"""The settings of a fit: one object for Python, the command, whose options are made from it, and the studio."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

from asterism.equilibrium.errors import Error
from asterism.pattern.design.section import is_whole


class SettingError(Error, ValueError):
    """A setting of a fit is not allowed."""


@dataclass(frozen=True, kw_only=True)
class FitSettings:
    """How a design for a target is found.

    Attributes
    ----------
    stretch : stretch of the fabric; by default the smallest one of the law whose stars contract differently enough.
    needles : number of needles that hold the outline at its places on the target; 0 for a free sheet. By default they
        stand at the corners of the target, and at distances of about 1.6 spacings between.
    border : hold the whole border along that of the target, in place of needles. By default if needles are not given
        and a quarter of the absolute Gauss curvature of the target is negative.
    width_mm : width of all arms; 1.2 mm by default. The fit changes lengths and thicknesses.
    exact : correct the sizes by the exact model, and check the design as `verify` does.
    corrections : largest number of corrections by the exact model; 0 leaves the fit by the preview as it is.
    nearest : if stars cannot contract as differently or curve as tightly as the target needs, make the sheet that comes
        nearest, in place of an error.
    within_percent : distance, in % of the diameter, within which the target counts as reached.

    Raises
    ------
    SettingError
        `needles` is not a whole number from 0 to 1000, or is 1 or 2, or is given with `border`; `corrections` is not a
        whole number from 0 to 20; or a width or distance is not a positive number.
    """

    stretch: float | None = None
    needles: int | None = None
    border: bool | None = None
    width_mm: float | None = None
    exact: bool = True
    corrections: int = 5
    nearest: bool = False
    within_percent: Annotated[float, "--within"] = 1.0

    def __post_init__(self) -> None:
        needles = self.needles
        if needles is not None and (not is_whole(needles) or not 0 <= needles <= 1000 or needles in (1, 2)):
            raise SettingError(f"needles = {needles!r}: must be 0, or a whole number from 3 to 1000")
        if needles is not None and self.border:
            raise SettingError(f"needles = {needles}: conflicts with border = True")
        if not is_whole(self.corrections) or not 0 <= self.corrections <= 20:
            raise SettingError(f"corrections = {self.corrections!r}: must be a whole number from 0 to 20")
        for name, value in (("width_mm", self.width_mm), ("within_percent", self.within_percent)):
            if value is not None and not 0.0 < value < math.inf:
                raise SettingError(f"{name} = {value!r}: must be a positive number")
