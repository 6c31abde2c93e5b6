"""The stars as a table of numbers, for scripts of solid modellers."""

from __future__ import annotations

import math

from asterism.print.job import Job

HEADING = "x, y of the centre; for every piece of an arm its angle (deg), begin, end, width there and there, height"


def star_table(job: Job) -> list[tuple[tuple[float, float], list[tuple[float, ...]]]]:
    """For each star its centre in the printer's coordinates, and its pieces: angle, begin, end, widths, height."""
    centres = job.placement.points(job.plan.centres) + job.printer.bed_centre_mm
    table: list[tuple[tuple[float, float], list[tuple[float, ...]]]] = [((float(x), float(y)), []) for x, y in centres]
    for strip in job.arms:
        angle = math.degrees(math.atan2(strip.direction[1], strip.direction[0])) + job.placement.turn_deg
        sizes = (strip.begin_mm, strip.end_mm, strip.begin_width_mm, strip.end_width_mm, strip.height_mm)
        table[strip.star][1].append((angle, *map(float, sizes)))
    return table


def number(value: float) -> str:
    """Up to six digits after the point, as OpenSCAD and Lua read them."""
    text = f"{value:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
