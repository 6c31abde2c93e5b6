"""Checks that a command can write its results: before it computes them."""

from __future__ import annotations

import errno
import json
import re
from contextlib import suppress
from pathlib import Path

from asterism.results.files import (
    EXPORT_COMPANIONS,
    EXPORT_SUMMARY_FILE,
    SUMMARY_COMPANIONS,
    SUMMARY_FILE,
    OutputError,
    check_no_dangling_link,
    failure_in_words,
    holds_result,
    staged,
)


def check_writable(directory: str | Path, *names: str) -> None:
    """Raise OutputError if files cannot be written into `directory`; leaves no trace.

    A summary.json of another program is not replaced, and neither are files with names of results without a summary.

    Parameters
    ----------
    names : of the files; without one, summary.json and all files that may stand beside it.
    """
    directory = Path(directory)
    if not names:
        names = (SUMMARY_FILE, *_entries(directory, SUMMARY_COMPANIONS))
    if SUMMARY_FILE in names and (foreign := _foreign(directory)) is not None:
        why = (
            "was not written by asterism"
            if foreign.name == SUMMARY_FILE
            else f"is no result's: there is no {SUMMARY_FILE} beside it"
        )
        raise OutputError(f"{foreign} {why}; choose another folder with -o")
    for name in names:
        with suppress(OSError):  # an error when writing names the reason
            if (directory / name).is_dir():
                is_folder = IsADirectoryError(errno.EISDIR, "", str(directory / name))
                raise OutputError(failure_in_words(is_folder, directory))
        check_no_dangling_link(directory / name)
    with suppress(_Rehearsal), staged(directory) as folder:
        (folder / names[0]).write_text("{}")
        raise _Rehearsal


def check_folder(directory: str | Path) -> None:
    """Raise OutputError if a folder for finished samples is something else."""
    directory = Path(directory)
    check_no_dangling_link(directory)
    with suppress(OSError):
        if directory.exists() and not directory.is_dir():
            is_file = FileExistsError(errno.EEXIST, "", str(directory))
            raise OutputError(failure_in_words(is_file, directory))


def check_kept(file: Path, directory: str | Path, *written: str) -> None:
    """Raise OutputError if a file that is read has the place and name of a file that will be `written`."""
    if any(one.name in written and one.parent.resolve() == Path(directory).resolve() for one in (file, file.resolve())):
        raise OutputError(f"--output: {str(directory)!r} is where {file.name} is and stays; choose another name")


def _entries(directory: Path, pattern: str) -> list[str]:
    """Sorted names in a directory that match a pattern; none without a directory."""
    with suppress(OSError):
        return sorted(entry.name for entry in directory.iterdir() if re.fullmatch(pattern, entry.name))
    return []


def _foreign(directory: Path) -> Path | None:
    """A file of another program with the name of a result file; None without one."""
    with suppress(OSError):  # there is no folder, or an error when writing names the reason
        if holds_result(directory):
            return directory / SUMMARY_FILE if _is_foreign(directory / SUMMARY_FILE) else None
        names = sorted(file.name for file in directory.iterdir() if file.is_file())
        exported = EXPORT_COMPANIONS if EXPORT_SUMMARY_FILE in names else ""
        mine = (name for name in names if re.fullmatch(SUMMARY_COMPANIONS, name) and not re.fullmatch(exported, name))
        return next((directory / name for name in mine), None)
    return None


def _is_foreign(summary: Path) -> bool:
    """Whether a file is not a summary: summaries have the key `version` or, for laws, `digest`."""
    try:
        summary_data = json.loads(summary.read_text(encoding="utf-8"))
    except OSError:
        return False  # there is no file, or an error when writing names the reason
    except ValueError:
        return True
    return not (isinstance(summary_data, dict) and {"version", "digest"} & summary_data.keys())


class _Rehearsal(Exception):
    """Ends a staged block, so that its files are discarded."""
