"""The texts of a design file that a document has read or written, by the number of the state that they hold."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from asterism.pattern.design.files import table_text
from asterism.studio.design_text import edited_text

# Texts that are kept, besides the first one.
MAX_TEXTS = 20


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

    Examples
    --------
    >>> texts = DesignTexts('# mine\\nname = "star"\\n')
    >>> texts.text(0, {"name": "star"}, Path("star.toml"))
    '# mine\\nname = "star"\\n'
    >>> texts.saved_revision
    0
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
        for old in sorted(self._by_revision)[1:-MAX_TEXTS]:
            del self._by_revision[old]
        self.saved_revision = revision
