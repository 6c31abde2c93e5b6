"""Reads the table of overhangs."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from asterism.measure.overhang import OVERHANG_RANGE_MM
from asterism.results.csv_cells import TableError, read_rows

OVERHANG_COLUMNS = ("strip", "end", "face", "overhang_mm")
ENDS = ("1", "2")
FACES = ("face", "back")


def read_overhangs(path: Path) -> list[float]:
    """The mean overhang of each strip, mm, of a table as `asterism strips overhang --form` writes it.

    The mean is geometric, over the ends and faces of a strip that were measured. Readings of one strip resemble each
    other; therefore strips count, and not readings, when the interval is computed (ASTM D1388).

    Raises
    ------
    TableError
        The table is wrong; the message names file, row and column.
    """
    readings: dict[str, list[float]] = {}
    seen: dict[tuple[str, str, str], int] = {}
    for row in read_rows(path, OVERHANG_COLUMNS, ("strip", "overhang_mm")):
        value = row.number_in("overhang_mm", *OVERHANG_RANGE_MM)
        strip, end, face = (row.cells.get(column, "") for column in OVERHANG_COLUMNS[:3])
        if not strip:
            raise row.wrong("strip", "every strip needs a name or number")
        if (end or face) and (strip, end, face) in seen:
            raise row.wrong("strip", f"{strip}, end {end}, {face} is already in row {seen[strip, end, face]}")
        seen[strip, end, face] = row.number
        if value is not None:
            readings.setdefault(strip, []).append(value)
    if not readings:
        raise TableError(path, None, None, "no overhang has been measured yet: fill in overhang_mm")
    return [float(np.exp(np.log(values).mean())) for values in readings.values()]
