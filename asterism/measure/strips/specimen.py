"""The test print: strips of several thicknesses, laid out on the printer's bed."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from asterism.measure.strips.strip_table import Direction
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
    size_mm : along x and y.
    direction : to the grain of the fabric, which lies along x; None if the specimen has one direction.
    """

    number: int
    thickness_mm: float
    centre_mm: tuple[float, float]
    size_mm: tuple[float, float]
    direction: Direction | None = None


@dataclass(frozen=True)
class Specimen:
    """All strips of a test print, of one length and width. They lie along x, or some along x and the others along y."""

    length_mm: float
    width_mm: float
    strips: tuple[PrintedStrip, ...]

    @property
    def has_directions(self) -> bool:
        """Strips lie along and across the grain of the fabric."""
        return any(strip.direction for strip in self.strips)

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
    both_directions: bool = False,
) -> Specimen:
    """Lay out `count` strips of each thickness on a bed, along x; or as many along x and above them along y.

    The thicknesses alternate, so that an uneven bed affects all of them equally.

    Raises
    ------
    DesignError
        The strips do not fit on the bed.
    """
    total, room = count * len(thicknesses_mm), [side - 2 * BED_MARGIN_MM for side in bed_mm]
    size = (length_mm, width_mm)
    blocks: list[tuple[Direction | None, tuple[float, float]]]
    blocks = [("along", size), ("across", size[::-1])] if both_directions else [(None, size)]
    given = f"{total * len(blocks)} strips of {length_mm:g} mm"
    fits = f"must fit on the bed of {bed_mm[0]:g} x {bed_mm[1]:g} mm: "
    strips: list[PrintedStrip] = []
    top = 0.0
    for direction, (x, y) in blocks:
        columns = min(math.floor((room[0] + STRIP_GAP_MM) / (x + STRIP_GAP_MM)), total)
        if columns < 1:
            raise DesignError("--length", f"{fits}it has room for {room[0]:g} mm", given)
        for place in range(total):
            row, column = divmod(place, columns)
            # shift the sequence if each column would hold one thickness
            turn = row if columns % len(thicknesses_mm) == 0 else 0
            thickness = thicknesses_mm[(place + turn) % len(thicknesses_mm)]
            centre = ((column - (columns - 1) / 2) * (x + STRIP_GAP_MM), top + row * (y + STRIP_GAP_MM) + y / 2)
            strips.append(PrintedStrip(len(strips) + 1, thickness, centre, (x, y), direction))
        top += math.ceil(total / columns) * (y + STRIP_GAP_MM)
    height = top - STRIP_GAP_MM
    if height > room[1]:
        raise DesignError("--count", f"{fits}they need {height:g} of {room[1]:g} mm", given)
    middle = [replace(strip, centre_mm=(strip.centre_mm[0], strip.centre_mm[1] - height / 2)) for strip in strips]
    return Specimen(length_mm, width_mm, tuple(middle))


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
