"""Writing results so that they appear complete or not at all."""

from __future__ import annotations

import errno
import json
import os
import re
import secrets
import shutil
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

from asterism.process import interruption
from equilibrium.errors import Error

# Whoever finds this file in a directory finds all the others, from the same run.
LAST = "summary.json"
# Files that belong to a summary.json, of whatever kind: those of an earlier one would be taken for the new one's.
BESIDE_SUMMARY = "|".join(
    (
        r"shape\.(vtu|png)|rods\.vtu|minimum-\d+\.(vtu|png)",  # simulate, preview
        r"report\.html|exact\.vtu|preview\.vtu",  # verify
        r"compare\.png",  # compare
        r"law\.png|cells\.csv",  # law show
    )
)
VERIFICATION = "verification"  # the key `model` of a summary of two shapes
# of an export: its summary, and which of those names it has too
EXPORT, BESIDE_EXPORT = "export.json", r"(shape|rods)\.vtu"

REASONS = {
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the disk quota is used up",
    errno.EFBIG: "the file would be larger than allowed",
    errno.EACCES: "no permission to write there",
    errno.EPERM: "no permission to write there",
    errno.EROFS: "the disk is read-only",
    errno.ENOTDIR: "a file is in the way",
    errno.EEXIST: "a file is in the way",
    errno.EISDIR: "a folder is in the way",
    errno.ENAMETOOLONG: "the name is too long",
}


class OutputError(Error):
    """Results cannot be written; the message is one line that says where and why."""


@contextmanager
def staged(directory: str | Path, stale: str | None = None) -> Iterator[Path]:
    """Collect files in a hidden folder, and move them into `directory` together at the end.

    The folder lies on the same disk as `directory`, which is made if it is missing. If the block ends with an
    exception or is interrupted, nothing is left behind and earlier results in `directory` stay as they were.

    Parameters
    ----------
    stale : pattern of names (regular expression, the whole name) that belong to this kind of result: earlier files of
        such a name that are not written again go away in the same moment.

    Yields
    ------
    The folder to write into. Files only, no folders.

    Raises
    ------
    OutputError
        If anything cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> target = Path(tempfile.mkdtemp()) / "star"
    >>> with staged(target) as folder:
    ...     _ = (folder / "summary.json").write_text("{}")
    >>> [file.name for file in target.iterdir()]
    ['summary.json']
    """
    directory = Path(directory)
    staging: Path | None = None
    made: list[Path] = []
    try:
        # inside an existing directory the disk is certainly the same; a missing one appears by a single renaming
        beside = directory if directory.exists() else directory.parent
        made = [parent for parent in (beside, *beside.parents) if not parent.exists()]
        staging = beside / f".asterism-{secrets.token_hex(4)}"
        staging.mkdir(parents=True)
        yield staging
        with _signals_held():
            _publish(staging, directory, stale)
            interruption.written()
    except OSError as error:
        raise OutputError(_sentence(error, directory)) from error
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)
        for parent in made:
            # those that hold results now are not empty, and stay
            with suppress(OSError):
                parent.rmdir()


def check_writable(directory: str | Path, name: str = LAST) -> None:
    """Raise OutputError now if a file could not be written into `directory` later; leaves no trace.

    A summary.json that is somebody else's is not written over, nor are files with names of results and no summary.json.
    """
    directory = Path(directory)
    if name == LAST and (foreign := _foreign(directory)) is not None:
        why = "was not written by asterism" if foreign.name == LAST else f"is no result's: there is no {LAST} beside it"
        raise OutputError(f"{foreign} {why}; choose another folder with -o")
    with suppress(OSError):
        if (directory / name).is_dir():
            raise OutputError(_sentence(IsADirectoryError(errno.EISDIR, "", str(directory / name)), directory))
    with suppress(_Rehearsal), staged(directory) as folder:
        (folder / name).write_text("{}")
        raise _Rehearsal


@contextmanager
def staged_result(directory: str | Path) -> Iterator[Path]:
    """As `staged`, for files that belong to a summary.json: those of an earlier result, of whatever kind, are removed.

    A folder without a summary.json holds no result; all its files stay.

    Raises
    ------
    OutputError
        The files cannot be written there.
    """
    with staged(directory, stale=BESIDE_SUMMARY if holds_result(directory) else None) as folder:
        yield folder


def check_kept(file: Path, directory: str | Path, *written: str) -> None:
    """Raise OutputError if a file that is read is one of those that will be `written` into a directory."""
    if any(one.name in written and one.parent.resolve() == Path(directory).resolve() for one in (file, file.resolve())):
        raise OutputError(f"--output: {str(directory)!r} is where {file.name} is and stays; choose another name")


def holds_result(directory: str | Path) -> bool:
    """Whether a finished result lies there, whatever other files do."""
    return (Path(directory) / LAST).is_file()


def _foreign(directory: Path) -> Path | None:
    """The file that stands where a result would: a summary.json that is none, or others without one."""
    with suppress(OSError):  # there is no folder, or writing will say why not
        if holds_result(directory):
            return directory / LAST if _is_foreign(directory / LAST) else None
        names = sorted(file.name for file in directory.iterdir() if file.is_file())
        exported = BESIDE_EXPORT if EXPORT in names else ""
        mine = (name for name in names if re.fullmatch(BESIDE_SUMMARY, name) and not re.fullmatch(exported, name))
        return next((directory / name for name in mine), None)
    return None


def _is_foreign(summary: Path) -> bool:
    """Whether there is a file that is no summary: those of results say a version, a law's its digest."""
    try:
        found = json.loads(summary.read_text(encoding="utf-8"))
    except OSError:
        return False  # there is none, or writing will say why not
    except ValueError:
        return True
    return not (isinstance(found, dict) and {"version", "digest"} & found.keys())


def write_file(path: str | Path, content: str | bytes) -> None:
    """Write one file, complete or not at all; text as UTF-8."""
    path = Path(path)
    with staged(path.parent) as folder:
        (folder / path.name).write_bytes(content.encode() if isinstance(content, str) else content)


class _Rehearsal(Exception):
    """Ends a staged block without publishing."""


def _publish(staging: Path, directory: Path, stale: str | None) -> None:
    """Move every file of `staging` into `directory` and take away what is stale there, or do nothing."""
    names = sorted((file.name for file in staging.iterdir()), key=lambda name: (name == LAST, name))
    for name in names:
        _flush(staging / name)
    if not directory.exists():
        os.rename(staging, directory)
        return
    previous = staging / ".previous"
    previous.mkdir()
    for name in names:
        if (directory / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(directory / name))
        if (directory / name).exists():
            _keep(directory / name, previous / name)
    found = [file.name for file in directory.iterdir() if stale and re.fullmatch(stale, file.name) and file.is_file()]
    moved: list[str] = []
    try:
        for name in sorted(set(found) - set(names)):
            os.replace(directory / name, previous / name)
        for name in names:
            moved.append(name)
            os.replace(staging / name, directory / name)
    except BaseException:
        for kept in list(previous.iterdir()):
            if kept.name in moved or not (directory / kept.name).exists():
                os.replace(kept, directory / kept.name)
                moved = [name for name in moved if name != kept.name]
        for name in moved:
            if not (staging / name).exists():
                (directory / name).unlink(missing_ok=True)
        raise


def _keep(file: Path, copy: Path) -> None:
    """A second name for a file where the disk can do that, else a copy."""
    try:
        os.link(file, copy)
    except OSError:
        shutil.copy2(file, copy)


def _flush(file: Path) -> None:
    """Onto the disk: some file systems only notice here that they are full."""
    with open(file, "rb+") as stream:
        os.fsync(stream.fileno())


@contextmanager
def _signals_held() -> Iterator[None]:
    """Deliver Ctrl-C and a request to end after the block: it takes milliseconds and must not be cut in two."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    arrived: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        arrived.append(number)

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for held in arrived:
            signal.raise_signal(held)


def _sentence(error: OSError, directory: Path) -> str:
    """One line: what could not be written, and why."""
    where = Path(error.filename or directory)
    for number, part in enumerate(where.parts):
        if part.startswith(".asterism-"):
            where = directory.joinpath(*where.parts[number + 1 :])
            break
    reason = REASONS.get(error.errno or 0, (error.strerror or str(error)).lower())
    return f"cannot write {where}: {reason}"
