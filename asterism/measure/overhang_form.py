"""The form of the cantilever test: a page to print with the slope at 1:1, and a table to fill in."""

from __future__ import annotations

import textwrap
from itertools import product
from pathlib import Path

import numpy as np

from asterism.measure.overhang import ENDS, FACES, OVERHANG_COLUMNS, SLOPE_DEG
from asterism.measure.strips.form import HELP_PEN, TEXT_PEN
from asterism.print.drawing import A4_MM, Drawing, DrawingLayer, Label, Polyline, rectangle
from asterism.print.formats.pdf import write_pdf
from asterism.results.files import OutputError, staged

FORM_FILES = ("overhangs.csv", "overhangs.pdf")
STRIPS = 4
# size of each strip
STRIP_MM = (25.0, 200.0)
SLOPE_PEN = DrawingLayer("slope", "#c8553d", 0.3)
# horizontal side of the printed slope
_SLOPE_MM = 100.0
# characters of a line of the instructions
_LETTERS = 108
_LEFT_MM = 15.0


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
    table, text = Path(directory) / FORM_FILES[0], _csv_text()
    if table.exists() and table.read_bytes() != text.encode():
        raise OutputError(f"{table} exists and may have been filled in; choose another directory with --form")
    with staged(directory) as folder:
        (folder / FORM_FILES[0]).write_text(text, encoding="utf-8", newline="\n")
        write_pdf(folder / FORM_FILES[1], [_page()])
    return FORM_FILES


def _steps() -> list[str]:
    """The instructions, line by line."""
    width, length = STRIP_MM
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
    return [line for step in steps for line in textwrap.wrap(step, _LETTERS, subsequent_indent="    ")]


def _csv_text() -> str:
    """The table to fill in."""
    places = product(range(1, STRIPS + 1), ENDS, FACES)
    return "\n".join([",".join(OVERHANG_COLUMNS), *(f"{strip},{end},{face}," for strip, end, face in places)]) + "\n"


def _page() -> Drawing:
    items: list[Polyline | Label] = [
        Label(TEXT_PEN, np.array([_LEFT_MM, 278.0]), "Overhangs to measure how stiff a fabric bends", 6.0, bold=True)
    ]
    y = 268.0
    for line in _steps():
        items.append(Label(TEXT_PEN, np.array([_LEFT_MM, y]), line, 3.0))
        y -= 5.0
    items += _slope(y - 3.0)
    items += _table(104.0)
    return Drawing("Overhangs", np.zeros(2), np.array(A4_MM), tuple(items))


def _slope(top: float) -> list[Polyline | Label]:
    """The triangle to cut out: level above, upright at the table, and the slope."""
    depth = _SLOPE_MM * float(np.tan(np.radians(SLOPE_DEG)))
    left = 55.0
    corners = np.array([[left, top], [left + _SLOPE_MM, top - depth], [left, top - depth], [left, top]])
    edge = np.array([left + 3.0, top - depth + 4.0])
    return [
        Polyline(SLOPE_PEN, corners),
        Label(HELP_PEN, np.array([left - 2.0, top + 1.5]), "edge of the table", 3.0),
        Label(HELP_PEN, edge, f"{SLOPE_DEG:g} degrees at 1:1; lower side {_SLOPE_MM:g} mm", 3.0),
    ]


def _table(top: float) -> list[Polyline | Label]:
    """One row for each strip, one column for each end and side."""
    heads = ["strip", *(f"end {end}, {face}" for end, face in product(ENDS, FACES))]
    width, height = 36.0, 9.0
    items: list[Polyline | Label] = []
    for column, row in product(range(len(heads)), range(STRIPS + 1)):
        centre = (_LEFT_MM + width * (column + 0.5), top - height * (row + 0.5))
        items.append(rectangle(HELP_PEN, (width, height), centre))
        text = heads[column] if row == 0 else str(row) if column == 0 else ""
        if text:
            at = np.array([centre[0], centre[1] - 1.0])
            items.append(Label(TEXT_PEN, at, text, 3.0, end="middle", bold=row == 0))
    return items
