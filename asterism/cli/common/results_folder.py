"""The folder of a command's results, checked before anything is computed."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from asterism.results.files import SUMMARY_FILE, OutputError, check_writable


def results_folder(design: Path, output: Path | None, default: Path, *names: str) -> Path:
    """The folder given by the user, or the default one.

    Parameters
    ----------
    names : of the files that the command can write there; without one, summary.json and those that stand beside it.

    Raises
    ------
    OutputError
        The folder cannot be written to, holds files of another origin, or the results would replace the design.
    """
    directory = output or default
    for name in names or (SUMMARY_FILE,):
        with suppress(OSError):  # of a file that is not there
            if (directory / name).samefile(design):
                raise OutputError(
                    f"--output: {str(directory)!r} is where {design.name} is and stays; choose another name"
                )
    check_writable(directory, *names)
    return directory
