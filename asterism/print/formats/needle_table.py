"""CSV: the table of needles."""

from __future__ import annotations

import csv
import math
from pathlib import Path

from asterism.print.formats.registry import export_format
from asterism.print.needles import Needle
from asterism.results.words import fixed_point


@export_format("CSV", ".csv", "table")
def write_needle_table(path: Path, needles: tuple[Needle, ...]) -> None:
    """Write needles, one line each; unknown places in space are empty."""
    with path.open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(("number", "printed_x_mm", "printed_y_mm", "x_mm", "y_mm", "z_mm", "slides", "step"))
        for needle in needles:
            place = ("", "", "") if needle.place is None else tuple(_known(value) for value in needle.place)
            printed = tuple(fixed_point(value, 3) for value in needle.printed)
            table.writerow((needle.number, *printed, *place, needle.slides, needle.step))


def _known(value: float) -> str:
    return "" if math.isnan(value) else fixed_point(value, 3)
