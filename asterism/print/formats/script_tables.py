"""Tables of the stars' arms and of the drawn rods, for scripts."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import partial

from asterism.print.job import Job

ROD_HEADING = "height, whether the beginning and the end are round, and the points of the middle line: x, y, width"


HEADING = "x, y of the centre; for every piece of an arm its angle (deg), begin, end, width there and there, height"


def star_table(job: Job, opening: str, closing: str) -> list[str]:
    """A line for each star, with the brackets of a language.

    It holds the centre in the printer's coordinates, and the pieces: angle, begin, end, widths, height.
    """
    centres = job.placement.points(job.plan.centres) + job.printer.bed_centre_mm
    pieces: list[list[str]] = [[] for _ in centres]
    for strip in job.arms:
        angle = math.degrees(math.atan2(strip.direction[1], strip.direction[0])) + job.placement.turn_deg
        sizes = (strip.begin_mm, strip.end_mm, strip.begin_width_mm, strip.end_width_mm, strip.height_mm)
        pieces[strip.star].append(bracketed(map(number, (angle, *map(float, sizes))), opening, closing))
    return [
        f"  {bracketed([number(x), number(y), bracketed(of_star, opening, closing)], opening, closing)},"
        for (x, y), of_star in zip(centres.tolist(), pieces, strict=True)
    ]


def bracketed(parts: Iterable[str], opening: str, closing: str) -> str:
    """A list in the syntax of a language.

    >>> bracketed(["1", "2"], "{", "}")
    '{1, 2}'
    """
    return opening + ", ".join(parts) + closing


def number(value: float) -> str:
    """Up to six digits after the point, as OpenSCAD and Lua read them."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def rod_table(job: Job, opening: str, closing: str) -> list[str]:
    """A line for each piece of a drawn rod, in the printer's coordinates, with the brackets of a language."""
    row = partial(bracketed, opening=opening, closing=closing)
    lines = []
    for piece in job.rods:
        places = job.placement.points(piece.points) + job.printer.bed_centre_mm
        points = [row([number(x), number(y), number(w)]) for (x, y), w in zip(places, piece.width, strict=True)]
        ends = [number(float(is_round)) for is_round in piece.round_ends]
        lines.append(f"  {row([number(piece.height_mm), *ends, row(points)])},")
    return lines
