"""Drawn rods as a table of numbers, for scripts of solid modellers."""

from __future__ import annotations

from functools import partial

from asterism.print.formats.star_table import bracketed, number
from asterism.print.job import Job

ROD_HEADING = "height, whether the beginning and the end are round, and the points of the middle line: x, y, width"


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
