"""Where the print lies on the bed, and that it does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from asterism.export.printer import Printer
from asterism.export.solid import Step
from pattern.errors import DesignError
from pattern.layout import Floats, Layout


@dataclass(frozen=True)
class Placement:
    """From print coordinates to those of the sheets, whose origin is the middle of frame and bed.

    Attributes
    ----------
    turn_deg : counterclockwise about the design's origin.
    shift : (2,) mm, where the design's origin lies then.
    """

    turn_deg: float
    shift: Floats

    def points(self, printed: Floats) -> Floats:
        """(..., 2) mm."""
        if self.turn_deg == 0.0:
            return np.asarray(printed + self.shift)
        a = np.deg2rad(self.turn_deg)
        cos, sin = np.cos(a), np.sin(a)
        return np.asarray(printed @ np.array([[cos, sin], [-sin, cos]]) + self.shift)

    def step(self, step: Step) -> Step:
        """A terrace in sheet coordinates."""
        region: BaseGeometry = shapely.transform(step.region, self.points)
        return Step(step.height_mm, region)


def place(
    plan: Layout, steps: tuple[Step, ...], printer: Printer, turn_deg: float = 0.0, may_turn: bool = True
) -> Placement:
    """The design's origin in the middle of the bed, or else the sheet's own middle, or as near to it as may be.

    Parameters
    ----------
    turn_deg : counterclockwise.
    may_turn : whether another turn may be proposed: not if the fabric's stretch knows directions.

    Raises
    ------
    DesignError
        The plastic is larger than the bed, or the fabric than the frame.
    """
    corners = shapely.get_coordinates(shapely.convex_hull(steps[0].region))
    bed, frame = np.asarray(printer.bed_mm), np.asarray(printer.frame.size_mm)
    turned = Placement(turn_deg, np.zeros(2))
    plastic, sheet = turned.points(corners), turned.points(plan.border)
    least, most = _shifts(plastic, sheet, bed, frame)
    size, fabric = np.ptp(plastic, axis=0), np.ptp(sheet, axis=0)
    # corners are rounded to the grid
    if (size > bed + 1e-6).any():
        problem = f"must be within the {_times(bed)} mm that the {printer.name} reaches"
        advice = _advice(corners, plan.border, bed, frame) if may_turn else ""
        raise DesignError("stars", problem + advice, f"{_times(size)} mm of plastic")
    if (least > most + 1e-6).any():
        problem = f"must be within the frame of {_times(frame)} mm, with the plastic where the nozzle reaches"
        advice = _advice(corners, plan.border, bed, frame) if may_turn else ""
        raise DesignError("border", problem + advice, f"{_times(fabric)} mm of fabric")
    stays = (least <= 0.0) & (most >= 0.0)
    middle = np.round(-(sheet.min(axis=0) + sheet.max(axis=0)) / 2, 3)
    return Placement(turn_deg, np.where(stays, 0.0, np.clip(middle, least, most)))


def _shifts(plastic: Floats, sheet: Floats, bed: Floats, frame: Floats) -> tuple[Floats, Floats]:
    """The least and the largest shift (2,) at which the plastic is on the bed, and the fabric within the frame."""
    least = np.maximum(-bed / 2 - plastic.min(axis=0), -frame / 2 - sheet.min(axis=0))
    return least, np.minimum(bed / 2 - plastic.max(axis=0), frame / 2 - sheet.max(axis=0))


def _advice(plastic: Floats, sheet: Floats, bed: Floats, frame: Floats) -> str:
    """The least turn in degrees that makes plastic (n, 2) and sheet (m, 2) fit, in words; empty if there is none."""
    for turn in range(180):
        turned = Placement(turn, np.zeros(2))
        least, most = _shifts(turned.points(plastic), turned.points(sheet), bed, frame)
        if (least <= most).all():
            return f"; --turn {turn} makes it fit"
    return ""


def _times(size: Floats) -> str:
    return f"{size[0]:.1f} x {size[1]:.1f}"
