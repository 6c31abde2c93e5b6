"""Whether a print fits any printer that has a profile, and the frame on a printer's bed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.print_layout import print_layout
from asterism.print.bed_placement import TURNS_DEG, fitting_turn
from asterism.print.printer import Printer
from asterism.print.profiles import load_printer, profile_names


def size_warning(design: Design) -> Iterator[str]:
    """Yield a line if no printer with a profile can print a design in one piece in its frame.

    Examples
    --------
    >>> from asterism.pattern.gallery import load
    >>> list(size_warning(load("dome")))
    []
    >>> wide = {"stars": {"length_mm": 9.0}, "border": {"rectangle_mm": [400.0, 300.0]}}
    >>> next(size_warning(Design.from_dict(wide))).split(":")[0]
    'no known printer holds the print of 400 x 300 mm'
    """
    plan = print_layout(design)
    x, y = design.fabric.stretch_xy
    turns = TURNS_DEG if x == y else (0,)
    plastic, printers = _plastic_corners(plan), _readable_printers()
    if not printers or any(fitting_turn(plastic, plan.outline, printer, turns) is not None for printer in printers):
        return
    low, high = plan.outline.min(axis=0), plan.outline.max(axis=0)
    rooms = "; ".join(f"{printer.name} {_times(printer.bed_mm)} mm" for printer in printers)
    yield (
        f"no known printer holds the print of {_times(high - low)} mm: {rooms}, each less where its frame is smaller; "
        "print a smaller sheet or several, or add your printer (asterism printers)"
    )


def frame_warning(printer: Printer, is_known_to_fit: bool = False) -> Iterator[str]:
    """Yield a line if the frame stands out over the bed.

    Parameters
    ----------
    is_known_to_fit : the profile of the printer states this frame.

    Examples
    --------
    >>> next(frame_warning(load_printer("ender-3"))).split(":")[0]
    'the frame of 260 x 260 mm is larger than the bed of 220 x 220 mm'
    """
    frame, bed = printer.frame.size_mm, printer.bed_mm
    if not is_known_to_fit and any(a > b for a, b in zip(frame, bed, strict=True)):
        yield (
            f"the frame of {_times(frame)} mm is larger than the bed of {_times(bed)} mm: see that it meets nothing "
            "wherever bed and head go, or give the size of yours with --frame"
        )


def _readable_printers() -> list[Printer]:
    """The printers that have a profile; `asterism printers` reports files with mistakes."""
    printers = []
    for name in profile_names("printers"):
        try:
            printers.append(load_printer(name))
        except DesignError:
            continue
    return printers


def _plastic_corners(plan: Layout) -> Floats:
    """(n, 2) mm, corners around all arms and rods; drawn rods lie within the outline."""
    if plan.drawn is not None:
        return plan.outline
    arms = shapely.MultiPoint([*plan.centres, *plan.arm_tip]).buffer(0.5 * float(plan.arm_width.max()))
    return np.asarray(shapely.get_coordinates(shapely.convex_hull(arms)))


def _times(sides: Sequence[float] | Floats) -> str:
    width, depth = sides
    return f"{width:g} x {depth:g}"
