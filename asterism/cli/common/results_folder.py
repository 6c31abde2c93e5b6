"""The folder of a command's results, checked before anything is computed."""

from __future__ import annotations

from pathlib import Path

from asterism.results.files import SUMMARY_FILE, OutputError, check_kept, check_writable


def results_folder(
    design: Path, output: Path | None, default: Path, summary: str = SUMMARY_FILE, others: tuple[str, ...] = ()
) -> Path:
    """The folder given by the user, or the default one.

    Parameters
    ----------
    summary, others : names of the summary and of other files that the command will write there.

    Raises
    ------
    OutputError
        The folder cannot be written to, holds files of another origin, or the results would replace the design.
    """
    directory = output or default
    check_kept(design, directory, summary, *others)
    check_writable(directory, summary)
    for name in others:
        if (directory / name).is_dir():
            raise OutputError(f"cannot write {directory / name}: a folder is in the way")
    return directory
