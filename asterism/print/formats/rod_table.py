"""Drawn rods as a table of numbers, for scripts of solid modellers."""

from __future__ import annotations

from asterism.print.formats.star_table import number
from asterism.print.job import Job

ROD_HEADING = "height, whether the beginning and the end are round, and the points of the middle line: x, y, width"


def rod_table(job: Job, opening: str, closing: str) -> list[str]:
    """A line for each piece of a drawn rod, in the printer's coordinates, with the brackets of a language."""

    def bracketed(parts: list[str]) -> str:
        return opening + ", ".join(parts) + closing

    lines = []
    for piece in job.rods:
        places = job.placement.points(piece.points) + job.printer.bed_centre_mm
        points = [bracketed([number(x), number(y), number(w)]) for (x, y), w in zip(places, piece.width, strict=True)]
        ends = [number(float(is_round)) for is_round in piece.round_ends]
        lines.append(f"  {bracketed([number(piece.height_mm), *ends, bracketed(points)])},")
    return lines
