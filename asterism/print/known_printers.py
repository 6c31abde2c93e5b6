"""Whether a print fits any printer that has a profile, and the frame on a printer's bed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import shapely

from asterism.print.bed_placement import place_on_bed
from asterism.print.printer import Printer
from asterism.print.profiles import load_printer, profile_names
from asterism.print.solid import Terrace
from equilibrium.arrays import Floats
from pattern.design.design import Design
from pattern.design.errors import DesignError
from pattern.layout.layout import Layout
from pattern.layout.print_layout import print_layout

# a rectangle fits another one at some turn from 0 to 180 degrees, in either direction
_TURNS_DEG = range(180)


def size_warning(design: Design) -> Iterator[str]:
    """Yield a line if no printer with a profile can print a design in one piece in its frame.

    Examples
    --------
    >>> from pattern.gallery import load
    >>> list(size_warning(load("dome")))
    []
    >>> wide = {"stars": {"length_mm": 9.0}, "border": {"rectangle_mm": [400.0, 300.0]}}
    >>> next(size_warning(Design.from_dict(wide))).split(":")[0]
    'no known printer holds the print of 400 x 300 mm'
    """
    plan = print_layout(design)
    x, y = design.fabric.stretch_xy
    printers = _readable_printers()
    if not printers or any(_holds(printer, plan, may_turn=x == y) for printer in printers):
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


def _holds(printer: Printer, plan: Layout, may_turn: bool) -> bool:
    """Whether plastic and fabric fit the printer, its frame and its bed at any turn, or at none."""
    # drawn rods lie within the outline
    region = shapely.Polygon(plan.outline)
    if plan.drawn is None:
        region = shapely.MultiPoint([*plan.centres, *plan.arm_tip]).buffer(0.5 * float(plan.arm_width.max()))
    plastic = (Terrace(0.0, region),)
    for turn in _TURNS_DEG if may_turn else (0,):
        try:
            place_on_bed(plan, plastic, printer, turn, may_turn=False)
        except DesignError:
            continue
        return True
    return False


def _times(sides: Sequence[float] | Floats) -> str:
    width, depth = sides
    return f"{width:g} x {depth:g}"
