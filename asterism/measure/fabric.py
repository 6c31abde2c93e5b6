"""A fabric measured by hand: its modulus from a strip with a weight, its bending stiffness from overhanging strips."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import brentq

from asterism.draw.style import RED
from asterism.measure.new_strips import HELP_PEN, page_head, wrapped
from asterism.pattern.design.design import GRAVITY_M_S2
from asterism.pattern.design.errors import DesignError
from asterism.print.drawing import A4_MM, TEXT, Drawing, DrawingLayer, Label, Polyline, rectangle
from asterism.print.formats.pdf import write_pdf
from asterism.results.csv_table import TableError, read_rows
from asterism.results.files import OutputError, staged


def fabric_modulus_mpa(
    mass_g: float,
    width_mm: float,
    thickness_mm: float,
    stretch: float,
    poisson: float = 0.3,
    model: Literal["neo-hookean", "incompressible"] = "neo-hookean",
) -> float:
    """The modulus `fabric.modulus_mpa` with which a hanging strip has the measured stretch.

    Of fabric with two moduli a strip gives one of them at small stretches only.

    Parameters
    ----------
    mass_g : of the weight with its clamp; a strip that is long against its width contracts freely between the clamps.
    width_mm, thickness_mm : of the released strip.
    stretch : length between two marks under the weight over their distance without it; 1.02 to 3.
    poisson, model : as in the section `[fabric]` of the design that uses the modulus.

    Raises
    ------
    DesignError
        A value is out of range.

    Notes
    -----
    The energy is that of `discrete.energies.membrane`, with unit modulus; the strip is free of stress across. The
    force is proportional to the modulus.

    Examples
    --------
    >>> round(fabric_modulus_mpa(100.0, 40.0, 0.8, 1.2), 3)
    0.175
    """
    limits = (
        ("mass_g", mass_g, 0.1, 1e5),
        ("width_mm", width_mm, 1.0, 1e4),
        ("thickness_mm", thickness_mm, 0.01, 10.0),
        ("stretch", stretch, 1.02, 3.0),
        ("poisson", poisson, 0.0, 0.49),
    )
    for name, value, low, high in limits:
        if not low <= value <= high:
            raise DesignError(name, f"must be from {low:g} to {high:g}", value)
    stress = 1e-3 * mass_g * GRAVITY_M_S2 / (width_mm * thickness_mm)
    return stress / nominal_stress(stretch, poisson, model)


def nominal_stress(stretch: float, poisson: float, model: Literal["neo-hookean", "incompressible"]) -> float:
    """Force over the released cross-section of a stretched strip, over its modulus."""
    if model == "incompressible":
        return (stretch - stretch**-2) / 3.0
    mu, lame = 0.5 / (1.0 + poisson), poisson / (1.0 - poisson**2)

    def across(width: float) -> float:
        return mu * (width**2 - 1.0) + lame * np.log(stretch * width)

    width = float(brentq(across, 1e-3, 1.0))
    return float(mu * (stretch - 1.0 / stretch) + lame * np.log(stretch * width) / stretch)


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
    """Bending stiffness of a fabric for each mm of width, N mm."""

    n_mm: float  # the geometric mean of the readings
    low_n_mm: float  # low_n_mm and high_n_mm: 95 % confidence interval of the mean; nan for a single reading
    high_n_mm: float
    bending_length_mm: float  # cube root of stiffness over weight


def bending_stiffness(overhangs_mm: Sequence[float], mass_g_m2: float) -> BendingStiffness:
    """Bending stiffness from the overhangs at which a strip touches a slope of 41.5 degrees.

    Parameters
    ----------
    overhangs_mm : readings, each the length that hangs over the edge; 10 to 500 mm.
    mass_g_m2 : mass of a square metre of the released fabric, 10 to 5000 g.

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
        half = float(student.ppf(0.975, len(logs) - 1) * logs.std(ddof=1) / np.sqrt(len(logs)))
    low, middle, high = (float(weight * np.exp(3.0 * (mean + shift))) for shift in (-half, 0.0, half))
    return BendingStiffness(middle, low, high, float(np.exp(mean)))


def read_overhangs(path: Path) -> list[float]:
    """The mean overhang of each strip, mm, of a table as `asterism strips overhang --form` writes it.

    The mean is geometric, over the ends and faces of a strip that were measured. Readings of one strip resemble each
    other; therefore strips count, and not readings, when the interval is computed (ASTM D1388).

    Raises TableError: the table is wrong; the message names file, row and column.
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


FORM_FILES = ("overhangs.csv", "overhangs.pdf")
STRIPS = 4


def write_overhang_form(directory: str | Path) -> tuple[str, ...]:
    """Write the form of the cantilever test: overhangs.csv to fill in, and overhangs.pdf to print.

    Returns
    -------
    Names of the files.

    Raises
    ------
    OutputError
        The files cannot be written, or the directory holds a table that has been filled in.

    Examples
    --------
    >>> import tempfile
    >>> write_overhang_form(tempfile.mkdtemp())
    ('overhangs.csv', 'overhangs.pdf')
    """
    places = product(range(1, STRIPS + 1), ENDS, FACES)
    rows = [",".join(OVERHANG_COLUMNS), *(f"{strip},{end},{face}," for strip, end, face in places)]
    table, text = Path(directory) / FORM_FILES[0], "\n".join(rows) + "\n"
    if table.exists() and table.read_bytes() != text.encode():
        raise OutputError(f"{table} exists and may have been filled in; choose another directory with --form")
    with staged(directory) as folder:
        (folder / FORM_FILES[0]).write_text(text, encoding="utf-8", newline="\n")
        items, y = page_head("Overhangs to measure how stiff a fabric bends", _steps())
        items += [*_slope(y - 3.0), *_table(104.0)]
        write_pdf(folder / FORM_FILES[1], [Drawing("Overhangs", np.zeros(2), np.array(A4_MM), tuple(items))])
    return FORM_FILES


def _steps() -> list[str]:
    """The instructions, line by line."""
    width, length = 25.0, 200.0  # mm, of each strip
    steps = [
        f"1. Cut {STRIPS} strips of {width:g} x {length:g} mm of the released fabric, two along and two across. Do not "
        "stretch them. Let them lie flat for a day; a strip that curls by itself does not count.",
        "2. Glue this page on cardboard, cut along the red lines, and stand the triangle beside the edge of a table, "
        "its upper corner at the edge.",
        "3. Lay a strip on the table with a ruler on it. Push both over the edge, slowly, until the strip's tip meets "
        f"the slope of {SLOPE_DEG:g} degrees.",
        "4. Write down the length that hangs over the edge, in mm. Measure both ends of each strip, on its face and on "
        "its back.",
        "5. Weigh a piece of fabric of known size: grams over square metres is the mass.",
        "6. Type the overhangs into overhangs.csv, then  asterism strips overhang overhangs.csv --mass G",
    ]
    return [line for step in steps for line in wrapped(step)]


def _slope(top: float) -> list[Polyline | Label]:
    """The triangle to cut out: level above, upright at the table, and the slope."""
    width, left = 100.0, 55.0
    depth = width * float(np.tan(np.radians(SLOPE_DEG)))
    corners = np.array([[left, top], [left + width, top - depth], [left, top - depth], [left, top]])
    edge = np.array([left + 3.0, top - depth + 4.0])
    return [
        Polyline(DrawingLayer("slope", RED, 0.3), corners),
        Label(HELP_PEN, np.array([left - 2.0, top + 1.5]), "edge of the table", 3.0),
        Label(HELP_PEN, edge, f"{SLOPE_DEG:g} degrees at 1:1; lower side {width:g} mm", 3.0),
    ]


def _table(top: float) -> list[Polyline | Label]:
    """One row for each strip, one column for each end and side."""
    heads = ["strip", *(f"end {end}, {face}" for end, face in product(ENDS, FACES))]
    width, height = 36.0, 9.0
    items: list[Polyline | Label] = []
    for column, row in product(range(len(heads)), range(STRIPS + 1)):
        centre = (15.0 + width * (column + 0.5), top - height * (row + 0.5))
        items.append(rectangle(HELP_PEN, (width, height), centre))
        text = heads[column] if row == 0 else str(row) if column == 0 else ""
        if text:
            at = np.array([centre[0], centre[1] - 1.0])
            items.append(Label(TEXT, at, text, 3.0, end="middle", bold=row == 0))
    return items
