"""Files of results: each is written beside its place first, so that nobody finds half a file."""

from __future__ import annotations

import errno
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path
from socket import gethostname
from tempfile import TemporaryDirectory, TemporaryFile

from asterism.equilibrium.errors import Error
from asterism.pattern.design.files import read_table

# The summary goes first and comes last: a folder with it holds all files of the same run.
SUMMARY_FILE = "summary.json"
# it holds the design, which may hold the lines of drawings
MAX_SUMMARY_BYTES = 100_000_000
# Names of files that belong to a summary. Those of an earlier result are removed.
SUMMARY_COMPANIONS = "|".join(
    (
        r"shape\.(vtu|png|obj)|rods\.vtu|minimum-\d+\.(vtu|png)|(bond|spread)\.png",  # simulate, preview
        r"report\.html|(exact|preview)\.(vtu|obj)",  # verify
        r"compare\.png",  # compare
        r"law\.png",  # law show
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
SUMMARIES = {SUMMARY_FILE, EXPORT_SUMMARY_FILE}
_UNFINISHED = ".asterism-"
_HOST = re.sub(r"[^\w.]", "", gethostname())
_EARLIER = "earlier-"  # begins the name of a summary while the files of its result are replaced


class OutputError(Error):
    """Results cannot be written; the message is one line with the file and the reason."""


@contextmanager
def staged(directory: str | Path, stale: str | None = None) -> Iterator[Path]:
    """Collect files in a hidden folder, and move them into `directory` at the end.

    The directory is made if it is missing. If the block ends with an exception or an interruption, earlier results in
    `directory` remain unchanged.

    `stale`: regular expression for whole names of files of this kind of result. Earlier files with such a name that are
    not written again are removed.

    Yields
    ------
    The folder to write into. It may hold files, but not folders.

    Raises OutputError: a file cannot be written.
    """
    directory = Path(directory)
    clear_unfinished(directory)
    with _made(directory), TemporaryDirectory(prefix=f"{_UNFINISHED}{_HOST}-{os.getpid()}-", dir=directory) as folder:
        yield Path(folder)
        names = sorted(os.listdir(folder), key=lambda name: (name in SUMMARIES, name))
        for name in names:
            _check_no_folder(directory / name)
            with open(Path(folder, name), "rb+") as stream:
                os.fsync(stream.fileno())  # some file systems report a full disk at this point only
        # whoever is killed from here on leaves no old summary beside new files
        earlier = [name for name in SUMMARIES & {*names} if (directory / name).exists()]
        for name in earlier:
            os.replace(directory / name, Path(folder, f"{_EARLIER}{name}"))
        for name in names:
            try:
                os.replace(Path(folder, name), directory / name)
            except OSError:
                if name == names[0]:  # all earlier files are there
                    for summary in earlier:
                        os.replace(Path(folder, f"{_EARLIER}{summary}"), directory / summary)
                raise
        for file in list(directory.iterdir()):
            if stale and re.fullmatch(stale, file.name) and file.name not in names and file.is_file():
                file.unlink()


@contextmanager
def staged_result(directory: str | Path) -> Iterator[Path]:
    """As `staged`, for files of a result with a summary.json: files of an earlier result of any kind are removed.

    A folder without a summary.json holds no result, and all its files remain.

    Raises OutputError: the files cannot be written there.
    """
    known = holds_result(directory) or _was_interrupted(directory)
    with staged(directory, stale=SUMMARY_COMPANIONS if known else None) as folder:
        yield folder


def clear_unfinished(directory: str | Path) -> None:
    """Remove hidden folders of processes of this machine that were killed while they wrote into a directory."""
    for folder in Path(directory).glob(f"{_UNFINISHED}{escape(_HOST)}-*"):
        number = folder.name.removeprefix(f"{_UNFINISHED}{_HOST}-").split("-")[0]
        if number.isdecimal() and not _is_running(int(number)):
            shutil.rmtree(folder, ignore_errors=True)


def _is_running(number: int) -> bool:
    if os.name == "nt":
        return True  # such a question would end the process
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    except OSError:  # of another user
        pass
    return True


def _was_interrupted(directory: str | Path) -> bool:
    """Whether a process was killed while it replaced the files of a result."""
    return any(Path(directory).glob(f"{_UNFINISHED}*/{_EARLIER}*"))


def write_file(path: str | Path, content: str | bytes) -> None:
    """Write one file, complete or not at all; text in UTF-8."""
    with staged(Path(path).parent) as folder:
        (folder / Path(path).name).write_bytes(content.encode() if isinstance(content, str) else content)


def holds_result(directory: str | Path) -> bool:
    """Whether a directory holds a finished result."""
    return (Path(directory) / SUMMARY_FILE).is_file()


def check_folder(directory: str | Path) -> None:
    """Raise OutputError if a folder cannot be made or written to; leaves no trace."""
    with _made(Path(directory)), TemporaryFile(prefix=_UNFINISHED, dir=directory):
        pass


def check_writable(directory: str | Path, *names: str) -> None:
    """Raise OutputError if files cannot be written into `directory`; leaves no trace.

    `names`: of the files; without one, summary.json and all files that may stand beside it. Those of another program
    are not replaced.
    """
    directory = Path(directory)
    check_folder(directory)
    inside = sorted(os.listdir(directory)) if directory.exists() else []
    there = [name for name in inside if name == SUMMARY_FILE or re.fullmatch(SUMMARY_COMPANIONS, name)]
    with _made(directory):
        for name in names or there:
            _check_no_folder(directory / name)
    if not names and there and not _is_ours(directory):
        raise OutputError(f"{directory / there[0]} was not written by asterism; choose another folder with -o")


def check_file(path: Path, ending: str) -> None:
    """Raise OutputError if a file has another ending or cannot be written; leaves no trace."""
    if path.suffix.lower() != ending:
        raise OutputError(f"--output: {str(path)!r} must end with {ending}")
    check_writable(path.parent, path.name)


def _is_ours(directory: Path) -> bool:
    """Whether a folder holds a result or an export: summaries have the key `version` or, for laws, `digest`."""
    if not holds_result(directory):
        return (directory / EXPORT_SUMMARY_FILE).is_file() or _was_interrupted(directory)
    try:
        return bool({"version", "digest"} & read_table(directory / SUMMARY_FILE, MAX_SUMMARY_BYTES).keys())
    except Error:
        return False


def _check_no_folder(file: Path) -> None:
    with suppress(FileNotFoundError):
        file.stat()  # of a name that is too long: the error names it
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(file))


@contextmanager
def _made(directory: Path) -> Iterator[None]:
    """A folder for the block, in which an OSError becomes an OutputError; folders that stay empty go again."""
    made: list[Path] = []
    try:
        made = [folder for folder in (directory, *directory.parents) if not folder.exists()]
        directory.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        where = directory if error.filename is None or _UNFINISHED in str(error.filename) else error.filename
        reason = SYSTEM_ERRORS.get(error.errno or 0, (error.strerror or str(error)).lower())
        raise OutputError(f"cannot write {where}: {reason}") from error
    finally:
        for folder in made:
            with suppress(OSError):  # a folder with results is not empty
                folder.rmdir()
