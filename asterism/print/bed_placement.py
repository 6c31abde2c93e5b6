"""The place of the print on the bed, and whether it fits: on a printer, or on any with a profile."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.print.printer import Printer, load_printer, readable_profiles
from asterism.print.solid import Terrace

# a rectangle fits another one at some turn from 0 to 180 degrees, in either direction
TURNS_DEG = range(180)


@dataclass(frozen=True)
class BedPlacement:
    """The motion from printed coordinates to those of the sheets, whose origin is the middle of frame and bed."""

    turn_deg: float  # counterclockwise turn about the origin of the design
    shift: Floats  # (2,) mm, place of the origin of the design after the turn

    def points(self, printed: Floats) -> Floats:
        """Points (..., 2) mm after the motion."""
        if self.turn_deg == 0.0:
            return np.asarray(printed + self.shift)
        a = np.deg2rad(self.turn_deg)
        cos, sin = np.cos(a), np.sin(a)
        return np.asarray(printed @ np.array([[cos, sin], [-sin, cos]]) + self.shift)

    def step(self, step: Terrace) -> Terrace:
        """A terrace after the motion."""
        region: BaseGeometry = shapely.transform(step.region, self.points)
        return Terrace(step.height_mm, region)


def place_on_bed(
    plan: Layout, steps: tuple[Terrace, ...], printer: Printer, turn_deg: float, may_turn: bool
) -> BedPlacement:
    """Put the origin of the design to the middle of the bed, or else the middle of the sheet, or as near as possible.

    A `DesignError` says that the plastic is larger than the bed or the frame's opening, or the fabric than the frame;
    if the design `may_turn`, because its fabric has one stretch, it proposes a turn that helps.
    """
    corners = shapely.get_coordinates(shapely.convex_hull(steps[0].region))
    bed, frame, opening = (np.asarray(p) for p in (printer.bed_mm, printer.frame.size_mm, printer.frame.opening_mm))
    turned = BedPlacement(turn_deg, np.zeros(2))
    plastic, sheet = turned.points(corners), turned.points(plan.outline)
    least, most = _shifts(plastic, sheet, printer)
    size, fabric = np.ptp(plastic, axis=0), np.ptp(sheet, axis=0)
    field, problem, given = "stars" if plan.has_stars else "rods", "", f"{_times(size)} mm of plastic"
    # corners are rounded to the grid
    if (size > bed + 1e-6).any():
        problem = f"must be within the {_times(bed)} mm that the {printer.name} reaches"
    elif (size > opening + 1e-6).any():
        problem = f"must be within the {_times(opening)} mm between the bars of the frame"
    elif (least > most + 1e-6).any():
        field, given = "border", f"{_times(fabric)} mm of fabric"
        problem = f"must be within the frame of {_times(frame)} mm, with the plastic where it can be printed"
    if problem:
        turn = fitting_turn(corners, plan.outline, printer) if may_turn else None
        raise DesignError(field, problem + ("" if turn is None else f"; --turn {turn} makes it fit"), given)
    stays = (least <= 0.0) & (most >= 0.0)
    middle = np.round(-(sheet.min(axis=0) + sheet.max(axis=0)) / 2, 3)
    return BedPlacement(turn_deg, np.where(stays, 0.0, np.clip(middle, least, most)))


def room_mm(printer: Printer) -> Floats:
    """(2,) mm, width and depth of the printable area: on the bed, and between the bars of the frame."""
    return np.minimum(printer.bed_mm, printer.frame.opening_mm)


def _shifts(plastic: Floats, sheet: Floats, printer: Printer) -> tuple[Floats, Floats]:
    """Smallest and largest shift (2,) mm at which the plastic fits and the fabric lies within the frame."""
    room, frame = room_mm(printer), np.asarray(printer.frame.size_mm)
    least = np.maximum(-room / 2 - plastic.min(axis=0), -frame / 2 - sheet.min(axis=0))
    return least, np.minimum(room / 2 - plastic.max(axis=0), frame / 2 - sheet.max(axis=0))


def fitting_turn(plastic: Floats, sheet: Floats, printer: Printer, turns: Iterable[int] = TURNS_DEG) -> int | None:
    """The first turn at which the printer and its frame hold corners of plastic (n, 2) and sheet (m, 2); or None."""
    for turn in turns:
        turned = BedPlacement(turn, np.zeros(2))
        least, most = _shifts(turned.points(plastic), turned.points(sheet), printer)
        if (least <= most).all():
            return turn
    return None


def _times(size: Floats) -> str:
    return f"{size[0]:.1f} x {size[1]:.1f}"


def size_warning(design: Design) -> Iterator[str]:
    """Yield a line if no printer with a profile can print a design in one piece in its frame."""
    plan = layout(design)
    x, y = design.fabric.stretch_xy
    turns = TURNS_DEG if x == y else (0,)
    plastic = _plastic_corners(plan)
    # `asterism printers` reports files with mistakes
    printers = [printer for _, printer in readable_profiles("printers", load_printer, wrong=lambda error: None)]
    if not printers or any(fitting_turn(plastic, plan.outline, printer, turns) is not None for printer in printers):
        return
    low, high = plan.outline.min(axis=0), plan.outline.max(axis=0)
    rooms = "; ".join(f"{printer.name} {_sides(printer.bed_mm)} mm" for printer in printers)
    yield (
        f"no known printer holds the print of {_sides(high - low)} mm: {rooms}, each less where its frame is smaller; "
        "print a smaller sheet or several, or add your printer (asterism printers)"
    )


def frame_warning(printer: Printer) -> Iterator[str]:
    """Yield a line if the frame stands out over the bed."""
    frame, bed = printer.frame.size_mm, printer.bed_mm
    if any(a > b for a, b in zip(frame, bed, strict=True)):
        yield (
            f"the frame of {_sides(frame)} mm is larger than the bed of {_sides(bed)} mm: see that it meets nothing "
            "wherever bed and head go, or give the size of yours with --frame"
        )


def _plastic_corners(plan: Layout) -> Floats:
    """(n, 2) mm, corners around all arms and rods; drawn rods lie within the outline."""
    if plan.drawn is not None:
        return plan.outline
    arms = shapely.MultiPoint([*plan.centres, *plan.arm_tip]).buffer(0.5 * float(plan.arm_width.max()))
    return np.asarray(shapely.get_coordinates(shapely.convex_hull(arms)))


def _sides(sides: Sequence[float] | Floats) -> str:
    width, depth = sides
    return f"{width:g} x {depth:g}"
