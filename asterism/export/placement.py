"""Where the print lies on the bed, and that it does."""

from __future__ import annotations

import numpy as np
import shapely

from asterism.export.printer import Printer
from asterism.export.solid import Step
from pattern.errors import DesignError
from pattern.layout import Floats, Layout


def placed(plan: Layout, steps: tuple[Step, ...], printer: Printer) -> Floats:
    """(2,) mm, from the origin of the design to the middle of bed and frame: where the design's origin lies.

    Zero if the print fits around the middle, otherwise the shortest move that makes it fit.

    Raises
    ------
    DesignError
        The plastic is larger than the bed, or the fabric than the frame.
    """
    low, high = np.reshape(shapely.bounds(steps[0].region), (2, 2))
    _check_bed(low, high, steps, printer)
    half = np.asarray(printer.bed_mm) / 2
    # whichever side stands out is brought in
    shift = np.maximum(-half - low, 0.0) + np.minimum(half - high, 0.0)
    shift = np.where(shift > 0, np.ceil(shift * 1e3), np.floor(shift * 1e3)) / 1e3
    frame = np.asarray(printer.frame.size_mm)
    sheet_low, sheet_high = plan.border.min(axis=0) + shift, plan.border.max(axis=0) + shift
    if (sheet_low < -frame / 2).any() or (sheet_high > frame / 2).any():
        raise DesignError(
            "border", f"must be within the frame of {_times(frame)} mm", f"{_times(sheet_high - sheet_low)} mm"
        )
    return shift


def _check_bed(low: Floats, high: Floats, steps: tuple[Step, ...], printer: Printer) -> None:
    size, bed = high - low, np.asarray(printer.bed_mm)
    # corners are rounded to the grid
    if (size <= bed + 1e-6).all():
        return
    problem = f"must be within the {_times(bed)} mm that the {printer.name} reaches"
    if (turn := _fitting_turn(steps, bed)) is not None:
        problem += f"; turned by {turn} deg about the origin they would be"
    raise DesignError("stars", problem, f"{_times(size)} mm of plastic")


def _fitting_turn(steps: tuple[Step, ...], bed: Floats) -> int | None:
    """The least turn in degrees that makes the plastic fit the bed; None if there is none."""
    corners = shapely.get_coordinates(shapely.convex_hull(steps[0].region))
    for turn in range(1, 180):
        a = np.deg2rad(turn)
        turned = corners @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
        if (np.ptp(turned, axis=0) <= bed).all():
            return turn
    return None


def _times(size: Floats) -> str:
    return f"{size[0]:.1f} x {size[1]:.1f}"
