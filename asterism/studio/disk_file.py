"""A check before saving: whether a design file has changed since the document read or wrote it."""

from __future__ import annotations

from pathlib import Path

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import read_table
from asterism.studio.watcher import file_text


class FileChangedError(Error):
    """Another program has changed the file since the document read or wrote it; the message is one line."""


class OtherFileError(Error):
    """The file belongs to another design; the message is one line."""


def check_unchanged(path: Path, known: str | None) -> None:
    """Raise FileChangedError or OtherFileError if a file exists and its text is not the known one.

    Parameters
    ----------
    known : text that was last read from the file or written to it; None if the file is none of the document's.
    """
    if not path.exists():
        return
    try:
        text = file_text(path)
    except ValueError:
        text = None
    except OSError:
        return  # writing says what is wrong
    if text is not None and text == known:
        return
    if known is None:
        raise OtherFileError(f"{path.name} exists already and holds another design")
    try:
        Design.from_dict(read_table(path), path.parent)
    except Error as error:
        problem = str(error).removeprefix(f"{path}: ")
        raise FileChangedError(f"{path.name} was changed by another program and has a mistake: {problem}") from None
    raise FileChangedError(f"{path.name} was changed by another program")
