"""Errors of scans and outlines."""

from __future__ import annotations

from pathlib import Path

from asterism.equilibrium.errors import Error
from asterism.pattern.design.errors import one_line


class ScanError(Error, ValueError):
    """A scan or an outline cannot be read or compared; the message is one line that begins with the file."""

    def __init__(self, file: str | Path, problem: str):
        super().__init__(one_line(f"{file}: {problem}"))


def check_file(path: Path) -> None:
    """Raise ScanError unless there is a file."""
    if not path.is_file():
        raise ScanError(path, why_no_file(path))


def why_no_file(path: Path) -> str:
    """The reason why a path is no file."""
    if path.is_dir():
        return "is a folder, not a file"
    return "is a pipe or a device, not a file" if path.exists() else "is not there"
