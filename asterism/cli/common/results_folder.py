"""The folder of a command's results, checked before anything is computed."""

from __future__ import annotations

from pathlib import Path

from asterism.results.files import LAST, check_kept, check_writable


def results_folder(design: Path, output: Path | None, default: Path) -> Path:
    """The folder asked for, or the default one.

    Raises
    ------
    OutputError
        The folder cannot be written to, holds files of another origin, or the results would replace the design.
    """
    directory = output or default
    check_kept(design, directory, LAST)
    check_writable(directory)
    return directory
