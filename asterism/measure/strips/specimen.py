"""The test print: strips of several thicknesses, laid out on the printer's bed."""

from __future__ import annotations

import math
from dataclasses import dataclass

from asterism.pattern.design.errors import DesignError
from asterism.print.rounded import MAX_LAYER_OVER_LINE

THICKNESSES_MM = (0.30, 0.35, 0.40, 0.45)
# gap between strips: space for scissors
STRIP_GAP_MM = 8.0
BED_MARGIN_MM = 5.0
# thinnest layer of common printers
_MIN_LAYER_UM = 40


@dataclass(frozen=True)
class PrintedStrip:
    """A strip of plastic.

    Attributes
    ----------
    number : from 1, row by row from the lower left.
    centre_mm : centre, from the middle of the bed.
    """

    number: int
    thickness_mm: float
    centre_mm: tuple[float, float]


@dataclass(frozen=True)
class Specimen:
    """All strips of a test print. They are parallel to x and have one length and width."""

    length_mm: float
    width_mm: float
    strips: tuple[PrintedStrip, ...]

    @property
    def thicknesses_mm(self) -> tuple[float, ...]:
        """The thicknesses, each once, the smallest first."""
        return tuple(sorted({strip.thickness_mm for strip in self.strips}))


def lay_out_specimen(
    bed_mm: tuple[float, float],
    thicknesses_mm: tuple[float, ...] = THICKNESSES_MM,
    count: int = 10,
    length_mm: float = 60.0,
    width_mm: float = 4.0,
) -> Specimen:
    """Lay out `count` strips of each thickness on a bed.

    The thicknesses alternate, so that an uneven bed affects all of them equally.

    Raises
    ------
    DesignError
        The strips do not fit on the bed.
    """
    total = count * len(thicknesses_mm)
    columns = min(math.floor((bed_mm[0] - 2 * BED_MARGIN_MM + STRIP_GAP_MM) / (length_mm + STRIP_GAP_MM)), total)
    rows = math.ceil(total / columns) if columns else 0
    pitch = (length_mm + STRIP_GAP_MM, width_mm + STRIP_GAP_MM)
    if columns == 0 or rows * pitch[1] - STRIP_GAP_MM > bed_mm[1] - 2 * BED_MARGIN_MM:
        room = max(math.floor((bed_mm[1] - 2 * BED_MARGIN_MM + STRIP_GAP_MM) / pitch[1]), 0) * columns
        problem = f"must fit on the bed of {bed_mm[0]:g} x {bed_mm[1]:g} mm: it has room for {room}"
        raise DesignError("--count" if room else "--length", problem, f"{total} strips of {length_mm:g} mm")
    strips = []
    for place in range(total):
        row, column = divmod(place, columns)
        # shift the sequence if each column would hold one thickness
        turn = row if columns % len(thicknesses_mm) == 0 else 0
        thickness = thicknesses_mm[(place + turn) % len(thicknesses_mm)]
        centre = ((column - (columns - 1) / 2) * pitch[0], (row - (rows - 1) / 2) * pitch[1])
        strips.append(PrintedStrip(place + 1, thickness, centre))
    return Specimen(length_mm, width_mm, tuple(strips))


def layer_heights(thicknesses_mm: tuple[float, ...], nozzle_mm: float) -> tuple[float, float]:
    """Largest heights (mm) of the first and of the other layers that give all thicknesses exactly.

    Raises
    ------
    DesignError
        The nozzle cannot print such layers.
    """
    heights = sorted(round(1000 * h) for h in thicknesses_mm)
    most = round(1000 * MAX_LAYER_OVER_LINE * nozzle_mm)
    in_one = heights[0] <= most
    step = math.gcd(*(h - heights[0] * in_one for h in heights)) or heights[0]
    others = next(step // parts for parts in range(1, step + 1) if step % parts == 0 and step // parts <= most)
    first = heights[0] if in_one else others
    if min(first, others) < _MIN_LAYER_UM:
        least = _MIN_LAYER_UM / 1000
        which = f"{least:g} to {most / 1000:g} mm (nozzle {nozzle_mm:g} mm)"
        problem = f"must be a first layer and equal others, of {which}"
        raise DesignError("--thickness", problem, ", ".join(f"{h:g}" for h in sorted(thicknesses_mm)))
    return first / 1000, others / 1000
