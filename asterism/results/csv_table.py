"""Reads CSV tables. Errors name the file, the row and the column."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

from asterism.equilibrium.errors import Error
from asterism.pattern.design.errors import one_line
from asterism.pattern.design.files import read_bytes


class TableError(Error, ValueError):
    """A table is wrong or cannot be read; the message is one line with the file, the row and the column.

    Parameters
    ----------
    row : number of the row, where the header is row 1; None for the whole file.
    column : name of the column; None for the whole row.
    problem : what is wrong, and what is allowed.
    """

    def __init__(self, file: str | Path, row: int | None, column: str | None, problem: str):
        place = [str(file), *([f"row {row}"] if row else []), *([f"column {column}"] if column else [])]
        super().__init__(one_line(f"{', '.join(place)}: {problem}"))


@dataclass(frozen=True)
class Row:
    """A row of a table: the texts of its cells by column. A missing cell has an empty text."""

    file: Path
    number: int
    cells: dict[str, str]

    def wrong(self, column: str | None, problem: str) -> TableError:
        """An error at a column of this row."""
        return TableError(self.file, self.number, column, problem)

    def number_in(self, column: str, low: float, high: float, unit: str = "mm", needed: bool = False) -> float | None:
        """The number from `low` to `high` in a cell; None if the cell is empty.

        Raises TableError: it is no number or out of range, or empty although it is `needed`; the message says the unit.
        """
        text = self.cells.get(column, "")
        if not text:
            if needed:
                raise self.wrong(column, "is empty")
            return None
        try:
            value = float(text)
        except ValueError:
            if text.count(",") == 1 and text.replace(",", "").lstrip("+-").isdigit():
                raise self.wrong(column, f"{text!r}: write decimals with a point") from None
            raise self.wrong(column, f"{text!r} is not a number") from None
        if not math.isfinite(value):
            hint = "" if needed else "; leave the cell empty if it was not measured"
            raise self.wrong(column, f"{text} is not a finite number{hint}")
        if not low <= value <= high:
            hint = ""
            if unit == "mm" and 0 < value < low and (low <= 10 * value <= high or low <= 25.4 * value <= high):
                hint = "; is it in inches or centimetres?"
            raise self.wrong(column, f"{text} must be from {low:g} to {high:g} {unit}".rstrip() + hint)
        return value


def read_rows(path: Path, known: tuple[str, ...], required: tuple[str, ...]) -> list[Row]:
    """The rows below the header, without empty rows and comments, which begin with #.

    The columns may have any order. Commas, semicolons or tabs separate them.

    Parameters
    ----------
    known : names of the allowed columns.
    required : names of the columns that must exist.

    Raises TableError: the file cannot be read, or its header is wrong.
    """
    lines = _lines(path)
    if not lines:
        raise TableError(path, None, None, "is empty")
    first, head = lines[0]
    separator = max(",;\t", key=head.count)
    names = _cells(path, first, head, separator, 0)
    for name in names:
        if name not in known:
            raise TableError(path, first, None, f"no column {name!r} is known; there are {', '.join(known)}")
        if names.count(name) > 1:
            raise TableError(path, first, name, "is there twice")
    for name in required:
        if name not in names:
            raise TableError(path, first, None, f"the column {name} is missing")
    rows = []
    for number, line in lines[1:]:
        texts = _cells(path, number, line, separator, len(names))
        if len(texts) > len(names):
            problem = f"{len(texts)} cells, but the header has {len(names)}"
            if separator == ",":
                problem += "; write decimals with a point"
            raise TableError(path, number, None, problem)
        if any(texts):
            rows.append(Row(path, number, dict(zip(names, texts, strict=False))))
    return rows


def _cells(path: Path, number: int, line: str, separator: str, least: int) -> list[str]:
    """The texts of the cells of a line, without the empty ones at its end beyond the first `least` cells."""
    try:
        texts = [text.strip() for text in next(csv.reader([line], delimiter=separator))]
    except csv.Error as error:
        raise TableError(path, number, None, str(error)) from None
    while len(texts) > least and not texts[-1]:
        texts.pop()
    return texts


def _lines(path: Path) -> list[tuple[int, str]]:
    """Numbers and texts of the lines, without empty lines and comments."""
    try:
        # size of the largest table
        raw = read_bytes(path, 2_000_000)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise TableError(path, None, None, f"cannot be read: {reason.lower()}") from None
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        row = raw[: error.start].count(b"\n") + 1
        raise TableError(path, row, None, "is not UTF-8 text; save the table as CSV (UTF-8)") from None
    if "\0" in text:
        raise TableError(path, None, None, "is not text; save the table as CSV (UTF-8)")
    numbered = enumerate(io.StringIO(text, newline=None), 1)
    return [(n, line.rstrip("\n")) for n, line in numbered if line.strip(" ,;\t\n") and not line.startswith("#")]
