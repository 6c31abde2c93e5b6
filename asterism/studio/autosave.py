"""Unsaved work on a design file, kept beside it."""

from __future__ import annotations

import tomllib
from contextlib import suppress
from pathlib import Path
from typing import Any

from asterism.pattern.design.design import Design
from asterism.results.files import write_file

AUTOSAVE_SUFFIX = ".autosave.toml"


class Autosave:
    """The autosave of one design file.

    Parameters
    ----------
    design_path : the design file; it need not exist.
    is_taken : this session goes on with the autosave of a former one.

    Attributes
    ----------
    kept_work : the table that a former session left; None without one, or if it cannot be read.
    is_written : the file holds work of this session.
    """

    def __init__(self, design_path: Path, is_taken: bool = False) -> None:
        self.design_path, self.is_written = design_path, is_taken
        self.kept_work = None if is_taken else self._read()

    def _read(self) -> dict[str, Any] | None:
        try:
            table = tomllib.loads(self.path.read_text(encoding="utf-8"))
            Design.from_dict(table, self.design_path.parent)
        except (OSError, ValueError):
            return None
        return table

    @property
    def path(self) -> Path:
        """Where unsaved work is kept: beside the design, hidden."""
        return autosave_path(self.design_path)

    @property
    def _earlier_path(self) -> Path:
        """Where the work of a former session goes if new work needs its place."""
        return self.path.with_suffix(".earlier.toml")

    def write(self, text: str) -> None:
        """Keep the text of a design file.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        if self.kept_work is not None and not self.is_written:
            # neither taken nor forgotten yet
            with suppress(FileNotFoundError):
                self.path.replace(self._earlier_path)
        write_file(self.path, text)
        self.is_written = True

    def drop(self) -> None:
        """Take the work of this session away; that of a former one stays until it is taken or forgotten."""
        if self.is_written:
            self.path.unlink(missing_ok=True)
            self.is_written = False

    def discard(self) -> None:
        """Forget the work that a former session left."""
        self.kept_work = None
        self._earlier_path.unlink(missing_ok=True)
        if not self.is_written:
            self.path.unlink(missing_ok=True)


def autosave_path(path: Path) -> Path:
    """Where unsaved work on a design file is kept: beside it, hidden.

    Examples
    --------
    >>> autosave_path(Path("designs/dome.toml")).as_posix()
    'designs/.dome.autosave.toml'
    """
    stem = path.stem if path.suffix.lower() == ".toml" else path.name
    return path.with_name(f".{stem}{AUTOSAVE_SUFFIX}")
