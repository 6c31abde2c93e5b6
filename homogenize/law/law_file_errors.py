"""What is wrong with a file of a law, in one line, for laws of every kind."""

from __future__ import annotations

import tokenize
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from asterism.homogenize.errors import LawError, UnreadableLaw
from asterism.pattern.design.errors import DesignError

# what numpy and zipfile raise for files that are damaged, or no archives
DAMAGED_FILE_ERRORS = (
    KeyError,
    TypeError,
    ValueError,
    EOFError,
    RuntimeError,
    tokenize.TokenError,
    zipfile.BadZipFile,
    zlib.error,
)


@contextmanager
def law_file_errors(path: str | Path, part: str, remedy: str) -> Iterator[None]:
    """Within the block, errors of reading a file become those of a law.

    Parameters
    ----------
    part : of the file that holds a design or a material.
    remedy : how to make the file again.

    Raises
    ------
    LawError
        The file is damaged, or its `part` cannot be read.
    UnreadableLaw
        The file is missing, or cannot be read.
    """
    try:
        yield
    except OSError as error:
        if error.filename is None:  # no error of the disk: the archive points to places outside of its file
            raise LawError(f"{path}: is not a law, or damaged") from None
        raise UnreadableLaw(f"{path}: cannot be read: {error.strerror or error}") from None
    except DesignError as error:
        raise LawError(f"{path}: its {part} cannot be read: {error}; {remedy}") from None
    except DAMAGED_FILE_ERRORS as error:
        if isinstance(error, LawError):
            raise
        raise LawError(f"{path}: is not a law, or damaged") from None
