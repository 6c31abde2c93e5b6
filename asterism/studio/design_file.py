"""The file of a document: its text after edits, a check before it is overwritten, and edits by other programs."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import read_bytes, read_table, table_text


class DesignTexts:
    """Texts by revision. Edits keep the comments of the last one.

    Parameters
    ----------
    text : of the first state, or None.
    is_on_disk : the file of the document holds it.

    Attributes
    ----------
    on_disk : text that was last read from the document's file, or written to it; None without a file.
    saved_revision : of the state that the file holds; -1 without one.
    """

    def __init__(self, text: str | None, is_on_disk: bool = True) -> None:
        self._by_revision = {0: text} if text is not None else {}
        self._last = text
        self.on_disk = text if is_on_disk else None
        self.saved_revision = 0 if self.on_disk is not None else -1

    def text(self, revision: int, table: Mapping[str, Any], path: Path) -> str:
        """The text of a state for a document at `path`: that of the file it was read from, byte for byte."""
        return self._by_revision.get(revision) or self.edited(table, path, path)

    def edited(self, table: Mapping[str, Any], path: Path, design_path: Path) -> str:
        """The last text with the values of another table, as the text of a file at `path`."""
        if self._last is None or path.suffix.lower() != ".toml" or design_path.suffix.lower() != ".toml":
            return table_text(dict(table), path)
        return edited_text(self._last, table)

    def forget(self) -> None:
        """Forget the texts of all states: they are in another format."""
        self._by_revision.clear()

    def keep(self, revision: int, text: str) -> None:
        """The file holds this text of a state: it was read or written."""
        self._last = self.on_disk = self._by_revision[revision] = text
        for old in sorted(self._by_revision)[1:-20]:
            del self._by_revision[old]
        self.saved_revision = revision


def file_text(path: Path) -> str:
    """The text of a file with its line ends, so that it can be written back byte for byte."""
    return read_bytes(path).decode("utf-8-sig")


class FileWatch:
    """Compares a file with what it held before."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._stamp: tuple[int, int] | None = None
        self._text: str | None = None
        self.changed_text()

    def changed_text(self) -> str | None:
        """The text of the file if it differs from the last time; None otherwise, and while the file cannot be read."""
        try:
            status = self._path.stat()
            stamp = (status.st_mtime_ns, status.st_size)
            if stamp == self._stamp:
                return None
            text = file_text(self._path)
        except (OSError, ValueError):
            return None
        is_other = text != self._text
        self._stamp, self._text = stamp, text
        return text if is_other else None


class KeptFileError(Error):
    """A file is not written over without being asked; the message is one line.

    Attributes
    ----------
    kind : `file changed` by another program, `file exists` and holds another design, or `file read-only`.
    """

    def __init__(self, kind: str, text: str) -> None:
        super().__init__(text)
        self.kind = kind


def check_replaceable(path: Path, known: str | None) -> None:
    """Raise KeptFileError if a file may not be written, or its text is not the known one.

    Parameters
    ----------
    known : text that was last read from the file or written to it; None if the file is none of the document's.
    """
    if not path.exists():
        return
    try:
        text = file_text(path)
        is_known = text is not None and text == known
    except ValueError:
        is_known = False
    except OSError:
        is_known = True  # writing says what is wrong
    if not is_known:
        if known is None:
            raise KeptFileError("file exists", f"{path.name} exists already and holds another design")
        mistake = ""
        try:
            Design.from_dict(read_table(path), path.parent)
        except Error as error:
            mistake = f" and has a mistake: {str(error).removeprefix(f'{path}: ')}"
        raise KeptFileError("file changed", f"{path.name} was changed by another program{mistake}")
    if not path.stat().st_mode & 0o222:  # renaming another one onto it would succeed
        raise KeptFileError("file read-only", f"{path.name} is read-only")


_HEADER = re.compile(r"^\s*\[{1,2}\s*([\w.-]+)\s*\]{1,2}\s*(#.*)?$")


def edited_text(text: str, table: Mapping[str, Any]) -> str:
    """The text of a table that was made from a file by edits.

    Tables that hold the same as in the file keep their lines. A table that holds something else is written anew, under
    the comment above its header. Lists of tables, as `[[pins]]`, count as one table.

    Examples
    --------
    >>> print(edited_text("# mine\\n[stars]\\nlength_mm = 9.0 # long\\n\\n[border]\\nrings = 2 # small\\n",
    ...                   {"stars": {"length_mm": 9.0}, "border": {"rings": 3}}))
    # mine
    [stars]
    length_mm = 9.0 # long
    <BLANKLINE>
    [border]
    rings = 3
    <BLANKLINE>
    """
    whole = table_text(dict(table), Path("design.toml"))
    try:
        kept = _merged(_blocks(text), _blocks(whole))
        return kept if tomllib.loads(kept) == tomllib.loads(whole) else whole
    except ValueError:
        return whole


def _blocks(text: str) -> dict[str, list[str]]:
    """Lines that belong together, one table or all tables of one list: comments above the header, and the rest.

    By the dotted header, as `stars.override`; empty for the lines before the first header.
    """
    blocks = {"": ["", ""]}
    name, waiting = "", ""
    for line in text.splitlines(keepends=True):
        if header := _HEADER.match(line):
            name = header[1]
            if name not in blocks:
                blocks[name], waiting = [waiting, ""], ""
        elif not line.strip() or line.lstrip().startswith("#"):
            waiting += line  # belongs to the header that follows, if one follows
            continue
        blocks[name][1] += waiting + line
        waiting = ""
    blocks[name][1] += waiting
    return blocks


def _merged(old: dict[str, list[str]], new: dict[str, list[str]]) -> str:
    """The old blocks where they hold the same as the new ones, else the new ones in the place of the old."""
    order = [name for name in old if name in new]
    for name in new:
        if name not in order:
            relatives = [k for k, other in enumerate(order) if other.split(".")[0] == name.split(".")[0]]
            order.insert(relatives[-1] + 1 if relatives else len(order), name)
    merged = ""
    for name in order:
        comment, text = old.get(name, new[name])
        part = comment + (text if tomllib.loads(text) == tomllib.loads(new[name][1]) else new[name][1])
        if part.strip():
            is_apart = not merged or part.startswith("\n") or merged.endswith("\n\n")
            merged += ("" if is_apart else "\n") + part + ("" if part.endswith("\n") else "\n")
    return merged
