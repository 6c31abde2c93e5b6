"""Writes result files so that they appear complete or not at all."""

from __future__ import annotations

import errno
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

from asterism.equilibrium.errors import Error
from asterism.process import interruption

# The summary is written last: a folder with it holds all files of the same run.
SUMMARY_FILE = "summary.json"
# Names of files that belong to a summary. Those of an earlier result are removed.
SUMMARY_COMPANIONS = "|".join(
    (
        r"shape\.(vtu|png|obj)|rods\.vtu|minimum-\d+\.(vtu|png)",  # simulate, preview
        r"report\.html|(exact|preview)\.(vtu|obj)",  # verify
        r"compare\.png",  # compare
        r"law\.png|cells\.csv",  # law show
        r"fit\.png|target\.obj",  # fit
        r"sweep\.(html|csv)",  # sweep
    )
)
# value of the key `model` in the summary of a verification
VERIFICATION_MODEL = "verification"
# summary of an export
EXPORT_SUMMARY_FILE = "export.json"
# names that exports share with other results
EXPORT_COMPANIONS = r"(shape|rods)\.vtu|shape\.obj"

# system errors in words
SYSTEM_ERRORS = {
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
    """Results cannot be written; the message is one line with the file and the reason."""


@contextmanager
def staged(directory: str | Path, stale: str | None = None) -> Iterator[Path]:
    """Collect files in a hidden folder, and move them into `directory` together at the end.

    The folder lies on the same disk as `directory`, which is made if it is missing. If the block ends with an exception
    or an interruption, the folder is removed, and earlier results in `directory` remain unchanged.

    Parameters
    ----------
    stale : regular expression for whole names of files of this kind of result. Earlier files with such a name that are
        not written again are removed in the same step.

    Yields
    ------
    The folder to write into. It may hold files, but not folders.

    Raises
    ------
    OutputError
        A file cannot be written.

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
        # an existing directory is on its own disk; a missing one appears by a single renaming
        check_no_dangling_link(directory)
        beside = directory if directory.exists() else directory.parent
        made = [parent for parent in (beside, *beside.parents) if not parent.exists()]
        staging = beside / f".asterism-{secrets.token_hex(4)}"
        staging.mkdir(parents=True)
        yield staging
        with _signals_held():
            _publish(staging, directory, stale)
            interruption.written()
    except OSError as error:
        raise OutputError(failure_in_words(error, directory)) from error
    finally:
        if staging is not None:
            shutil.rmtree(staging, ignore_errors=True)
        for parent in made:
            # folders with results are not empty, so that rmdir keeps them
            with suppress(OSError):
                parent.rmdir()


@contextmanager
def staged_result(directory: str | Path) -> Iterator[Path]:
    """As `staged`, for files of a result with a summary.json: files of an earlier result of any kind are removed.

    A folder without a summary.json holds no result, and all its files remain.

    Raises
    ------
    OutputError
        The files cannot be written there.
    """
    with staged(directory, stale=SUMMARY_COMPANIONS if holds_result(directory) else None) as folder:
        yield folder


def holds_result(directory: str | Path) -> bool:
    """Whether a directory holds a finished result."""
    return (Path(directory) / SUMMARY_FILE).is_file()


def check_no_dangling_link(path: Path) -> None:
    """Raise OutputError if a path is a link whose target does not exist: writing would replace the link."""
    with suppress(OSError):  # of a name that is too long: an error when writing names the reason
        if not path.is_symlink() or path.exists():
            return
        raise OutputError(failure_in_words(FileExistsError(errno.EEXIST, "a link to nothing", str(path)), path.parent))


def write_file(path: str | Path, content: str | bytes) -> None:
    """Write one file, complete or not at all; text in UTF-8."""
    path = Path(path)
    check_no_dangling_link(path)
    with staged(path.parent) as folder:
        (folder / path.name).write_bytes(content.encode() if isinstance(content, str) else content)


def _publish(staging: Path, directory: Path, stale: str | None) -> None:
    """Move all files of `staging` into `directory` and remove stale files there, or leave all as it was."""
    names = sorted((file.name for file in staging.iterdir()), key=lambda name: (name == SUMMARY_FILE, name))
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
    stale_files = [
        file.name for file in directory.iterdir() if stale and re.fullmatch(stale, file.name) and file.is_file()
    ]
    moved: list[str] = []
    try:
        for name in sorted(set(stale_files) - set(names)):
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
    """Make a hard link to a file, or a copy if the disk has no links."""
    try:
        os.link(file, copy)
    except OSError:
        shutil.copy2(file, copy)


def _flush(file: Path) -> None:
    """Write a file to the disk: some file systems report a full disk at this point only."""
    with open(file, "rb+") as stream:
        os.fsync(stream.fileno())


@contextmanager
def _signals_held() -> Iterator[None]:
    """Deliver Ctrl-C and termination signals after the block, which takes milliseconds and must be complete."""
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


def failure_in_words(error: OSError, directory: Path) -> str:
    """The file that cannot be written, and the reason."""
    where = Path(error.filename or directory)
    for number, part in enumerate(where.parts):
        if part.startswith(".asterism-"):
            where = directory.joinpath(*where.parts[number + 1 :])
            break
    reason = SYSTEM_ERRORS.get(error.errno or 0, (error.strerror or str(error)).lower())
    return f"cannot write {where}: {reason}"
