"""What can be wrong with a table of strips, in one line."""

from __future__ import annotations

from pathlib import Path


class StripsError(ValueError):
    """A table that cannot be read or used; `str` is one line with the file, its row and its column.

    Parameters
    ----------
    row : as a spreadsheet counts, the header is row 1; None for the file as a whole.
    """

    def __init__(self, file: str | Path, row: int | None, column: str | None, problem: str):
        place = [str(file), *([f"row {row}"] if row else []), *([f"column {column}"] if column else [])]
        super().__init__("".join(c if c.isprintable() else " " for c in f"{', '.join(place)}: {problem}"))


class NoMaterial(Exception):
    """The strips do not determine a material; the message is one line."""
