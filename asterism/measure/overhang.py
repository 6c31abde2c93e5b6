"""Bending stiffness of a fabric from the cantilever test: strips that hang over an edge."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from asterism.pattern.design.design import GRAVITY_M_S2
from asterism.pattern.design.errors import DesignError
from asterism.results.csv_cells import TableError, read_rows

# slope of the test
SLOPE_DEG = 41.5
OVERHANG_RANGE_MM = (10.0, 500.0)
# A strip of this length over its bending length hangs so far that the line from the edge to its tip falls by 41.5
# degrees, the slope of the test. The length of a heavy elastic strip over `(D/w)^(1/3)` is 2.0003 there (tests).
LENGTH_AT_SLOPE = 2.0
OVERHANG_COLUMNS = ("strip", "end", "face", "overhang_mm")
ENDS = ("1", "2")
FACES = ("face", "back")


class BendingStiffness(NamedTuple):
    """Bending stiffness of a fabric for each mm of width, N mm.

    Attributes
    ----------
    n_mm : the geometric mean of the readings.
    low_n_mm, high_n_mm : confidence interval of the mean; nan for a single reading.
    bending_length_mm : cube root of stiffness over weight.
    """

    n_mm: float
    low_n_mm: float
    high_n_mm: float
    bending_length_mm: float


def bending_stiffness(overhangs_mm: Sequence[float], mass_g_m2: float, confidence: float = 0.95) -> BendingStiffness:
    """Bending stiffness from the overhangs at which a strip touches a slope of 41.5 degrees.

    Parameters
    ----------
    overhangs_mm : readings, each the length that hangs over the edge; 10 to 500 mm.
    mass_g_m2 : mass of a square metre of the released fabric, 10 to 5000 g.
    confidence : level of the interval.

    Raises
    ------
    DesignError
        A value is out of range, or there is no reading.

    Notes
    -----
    `D = w c^3` with the weight w of a mm^2 and the bending length c, half of the overhang (Peirce, The handle of cloth
    as a measurable quantity, 1930; ASTM D1388). The interval follows from the scatter of the logarithms by Student's
    distribution. It leaves out errors that all readings share.

    Examples
    --------
    >>> stiffness = bending_stiffness([52.0, 50.0, 55.0, 51.0], 250.0)
    >>> [round(value, 4) for value in stiffness]
    [0.043, 0.0354, 0.0523, 25.9834]
    """
    from scipy.stats import t as student  # slow to import

    if not 10.0 <= mass_g_m2 <= 5000.0:
        raise DesignError("mass_g_m2", "must be from 10 to 5000 g for a square metre", mass_g_m2)
    if not 0.5 <= confidence <= 0.999:
        raise DesignError("confidence", "must be from 0.5 to 0.999", confidence)
    lengths = np.asarray(overhangs_mm, dtype=float)
    if len(lengths) == 0:
        raise DesignError("overhangs_mm", "must hold at least one overhang")
    for number, length in enumerate(lengths, 1):
        low, high = OVERHANG_RANGE_MM
        if not low <= length <= high:
            raise DesignError(f"overhangs_mm, reading {number}", f"must be from {low:g} to {high:g} mm", float(length))
    weight = 1e-9 * mass_g_m2 * GRAVITY_M_S2
    logs = np.log(lengths / LENGTH_AT_SLOPE)
    mean, half = float(logs.mean()), np.nan
    if len(logs) > 1:
        half = float(student.ppf(0.5 + confidence / 2, len(logs) - 1) * logs.std(ddof=1) / np.sqrt(len(logs)))
    low, middle, high = (float(weight * np.exp(3.0 * (mean + shift))) for shift in (-half, 0.0, half))
    return BendingStiffness(middle, low, high, float(np.exp(mean)))


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
