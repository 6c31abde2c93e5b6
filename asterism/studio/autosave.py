"""Unsaved work on design files, kept beside them: each session has a file of its own."""

from __future__ import annotations

import os
import re
import threading
from dataclasses import dataclass
from glob import escape
from itertools import count
from pathlib import Path
from typing import Any

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import file_identity, read_table
from asterism.results.files import write_file


@dataclass(frozen=True)
class KeptWork:
    """Unsaved work that another session has left, or still works on."""

    path: Path  # of its autosave
    table: dict[str, Any]
    time: float  # when it was written, s since 1970


class Autosave:
    """The autosave of this session for one design file, and those of other sessions.

    Parameters
    ----------
    design_path : the design file; it need not exist.
    taken : an autosave of another session, with which this one goes on.

    Attributes
    ----------
    kept : the work that other sessions have left, the newest first.
    problems : one line for each autosave that cannot be read.
    path : the file that holds work of this session; None without one.
    """

    def __init__(self, design_path: Path, taken: Path | None = None) -> None:
        self.design_path, self.path = design_path, taken
        self._identity = None if taken is None else file_identity(taken)
        self._lock = threading.Lock()  # the studio keeps work by itself while a request does
        self.kept: list[KeptWork] = []
        self.problems: list[str] = []
        for path in autosaves(design_path):
            if path == taken:
                continue
            try:
                table = read_table(path)
                Design.from_dict(table, design_path.parent, path)
                self.kept.append(KeptWork(path, table, path.stat().st_mtime))
            except (Error, OSError) as error:
                self.problems.append(f"unsaved work cannot be read: {error}")
        self.kept.sort(key=lambda kept: -kept.time)

    @property
    def is_written(self) -> bool:
        """Whether the file of this session is there, as this session has written it."""
        try:
            return self.path is not None and file_identity(self.path) == self._identity
        except OSError:  # another session has dropped it
            return False

    def write(self, text: str) -> None:
        """Keep the text of a design file, in a file that no other session uses.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        with self._lock:
            path = self.path if self.is_written else None
            if path is None:
                names = (f"{_stem(self.design_path)}{'' if k == 1 else f'-{k}'}.toml" for k in count(1))
                free = (self.design_path.with_name(name) for name in names)
                path = next(file for file in free if not os.path.lexists(file))
            write_file(path, text)
            self.path, self._identity = path, file_identity(path)

    def drop(self) -> None:
        """Take the work of this session away; that of others stays until it is taken or forgotten."""
        with self._lock:
            if self.is_written and self.path is not None:
                self.path.unlink(missing_ok=True)
            self.path = None

    def forget(self, name: str | None) -> None:
        """Remove the work of others from the disk: that in a file of this name, or all."""
        for kept in [kept for kept in self.kept if name in (None, kept.path.name)]:
            self.kept.remove(kept)
            kept.path.unlink(missing_ok=True)


def _stem(path: Path) -> str:
    return f".{path.stem if path.suffix.lower() == '.toml' else path.name}.autosave"


def autosaves(path: Path) -> list[Path]:
    """The files with unsaved work on a design file: beside it, hidden."""
    files = path.parent.glob(f"{escape(_stem(path))}*.toml")
    return [file for file in files if re.fullmatch(r"(-\d+)?\.toml", file.name.removeprefix(_stem(path)))]


def design_name(name: str) -> str | None:
    """The name of the design file of an autosave of this name; None if it is no autosave.

    >>> design_name(".dome.autosave.toml"), design_name(".dome.json.autosave-2.toml"), design_name("dome.toml")
    ('dome.toml', 'dome.json', None)
    """
    if (found := re.fullmatch(r"\.(.+)\.autosave(-\d+)?\.toml", name)) is None:
        return None
    return found[1] if found[1].endswith(".json") else f"{found[1]}.toml"
