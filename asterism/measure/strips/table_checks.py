"""Checks of a whole table of strips: values that are given twice, and columns that are swapped."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from asterism.measure.strips.reading import Reading
from asterism.results.csv_cells import Row

# the columns count as swapped if the median curvature of peeled strips is larger than with fabric by this factor
SWAPPED_CURVATURE_RATIO = 1.5


def check_given_once(rows: Sequence[Row], column: str, value: float | None, option: str) -> None:
    """Refuse an option whose value the table gives too.

    Raises
    ------
    TableError
        The option is given, and a cell of its column is filled.
    """
    for row in rows if value is not None else ():
        if text := row.cells.get(column, ""):
            raise row.wrong(column, f"is {text}, and {option} is {value:g}: {option} is for tables without this column")


def check_not_swapped(rows: Sequence[Row], readings: Sequence[Reading]) -> None:
    """Refuse a table whose peeled strips bend clearly more than the same strips with their fabric.

    Raises
    ------
    TableError
        The columns of strips with fabric and of peeled strips seem to be swapped.
    """
    curvature = {(each.strip, each.peeled): abs(each.curvature_per_mm or 0.0) for each in readings if not each.left_out}
    strips = [strip for strip, peeled in curvature if peeled and (strip, False) in curvature]
    pairs = np.array([[curvature[strip, False], curvature[strip, True]] for strip in strips]).reshape(-1, 2)
    if not len(pairs) or np.median(pairs[:, 1]) <= SWAPPED_CURVATURE_RATIO * np.median(pairs[:, 0]):
        return
    first = int(np.argmax(pairs[:, 1] > pairs[:, 0]))
    row = next(row for row in rows if row.cells["strip"] == strips[first])
    filled = (name for name, text in row.cells.items() if name.startswith("peeled_") and text)
    with_fabric, peeled = pairs[first]
    problem = f"the strip bends by {peeled:.4f} /mm, with its fabric by {with_fabric:.4f} /mm: peeled strips must bend "
    raise row.wrong(next(filled), problem + "less; are the columns with fabric and peeled swapped?")
