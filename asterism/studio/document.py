"""The document of the studio: a design file's table with undo, saved state and autosave."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from asterism.results.files import write_file
from asterism.studio import painted
from asterism.studio.changes import with_changes
from asterism.studio.history import History, Step
from pattern.design.design import Design
from pattern.design.files import read_table, table_text
from pattern.layout.build import layout
from pattern.layout.layout import Layout


class Document:
    """A design that is being edited.

    Every change gives a new table, which is checked by the project's own parser before it replaces the old one. Changes
    of one gesture are one step of undo.

    Attributes
    ----------
    path : the design file; it need not exist yet.
    layout : of the last table that was laid out, see `check`.
    kept_work : the table of an autosave that a former session left; None without one, or if it cannot be read.
    """

    def __init__(self, table: Mapping[str, Any], path: Path, text: str | None = None) -> None:
        self.path = path
        self._history = History(dict(table))
        self._gesture: Any = None
        self._saved_revision = 0 if text is not None else -1
        self._texts = {0: text} if text is not None else {}
        self._has_autosave = False
        self._is_checked = False
        self.kept_work = self._read_autosave()
        self.layout: Layout = self.check()

    @classmethod
    def open(cls, path: Path) -> Document:
        """The document of a design file.

        Raises
        ------
        DesignError
            The file is not a design that can be printed.
        """
        table = read_table(path)
        Design.from_dict(table, path.parent, path)
        return cls(table, path, path.read_text(encoding="utf-8-sig"))

    @classmethod
    def copy_of(cls, source: Path, path: Path) -> Document:
        """A new document, to be saved as `path`, with the text of another design file."""
        document = cls(read_table(source), path)
        document._texts = {0: source.read_text(encoding="utf-8-sig")}
        return document

    @property
    def table(self) -> dict[str, Any]:
        """The table of the design file, as it is shown."""
        return self._history.shown.table

    @property
    def revision(self) -> int:
        """Number of the state that is shown."""
        return self._history.shown.revision

    @property
    def history(self) -> History:
        """The states before and after."""
        return self._history

    @property
    def is_saved(self) -> bool:
        """Whether the file holds this state."""
        return self.revision == self._saved_revision

    @property
    def text(self) -> str:
        """The text of the design file. A state that was read from a file gives that file's text, comments included."""
        return self._texts.get(self.revision) or table_text(self.table, self.path)

    @property
    def autosave_path(self) -> Path:
        """Where unsaved work is kept: beside the design, hidden."""
        return self.path.with_name(f".{self.path.stem}.autosave.toml")

    def design(self) -> Design:
        """The design of this state.

        Raises
        ------
        DesignError
            A value is out of range.
        """
        return Design.from_dict(self.table, self.path.parent)

    def check(self) -> Layout:
        """Lay the sheet out, and keep the layout.

        Raises
        ------
        DesignError
            The stars do not fit the sheet, or the outline cannot be cut.
        """
        self.layout = layout(self.design())
        self._is_checked = True
        return self.layout

    def apply(self, table: dict[str, Any], gesture: Any, label: str) -> None:
        """Show another table: as a new step, or in place of the last one if the gesture is the same.

        Raises
        ------
        DesignError
            A value is out of range; the document stays as it is.
        """
        Design.from_dict(table, self.path.parent)
        if gesture is not None and gesture == self._gesture:
            self._history.replace(table)
        else:
            self._history.push(table, label)
            self._gesture = gesture
        self._is_checked = False

    def end_gesture(self) -> None:
        """Lay the sheet out if it has changed; the next change is a step of its own.

        Raises
        ------
        DesignError
            The sheet cannot be laid out; the whole gesture is taken back.
        """
        self._gesture = None
        if not self._is_checked:
            try:
                self.check()
            except Exception:
                self.take_back()
                raise

    def take_back(self) -> None:
        """Forget the last step: the sheet cannot be laid out with it."""
        self._history.drop()
        self._gesture = None
        self.check()

    def change(self, changes: Mapping[str, Any], gesture: Any = None) -> None:
        """Other values at dotted keys of the design file; see `with_changes`."""
        self.apply(with_changes(self.table, changes), gesture, ", ".join(sorted(changes))[:60])

    def paint(self, sites: Sequence[painted.Site], sizes: Mapping[str, Sequence[float | None]], gesture: Any) -> None:
        """Other sizes (mm) of stars at lattice sites."""
        self._stars(painted.painted(self._entries(), sites, sizes), gesture, "sizes")

    def remove(self, sites: Sequence[painted.Site], gesture: Any = None) -> None:
        """Remove stars."""
        self._stars(painted.removed(self._entries(), sites), gesture, "remove")

    def restore(self, sites: Sequence[painted.Site], gesture: Any = None) -> None:
        """Bring removed stars back."""
        self._stars(painted.restored(self._entries(), sites), gesture, "restore")

    def reset(self, sites: Sequence[painted.Site], gesture: Any = None) -> None:
        """Give stars the sizes of the design's profiles."""
        self._stars(painted.reset(self._entries(), sites), gesture, "reset")

    def _entries(self) -> dict[painted.Site, dict[str, Any]]:
        return painted.entries_by_site(self.table, self.layout)

    def _stars(self, entries: Mapping[painted.Site, Mapping[str, Any]], gesture: Any, label: str) -> None:
        self.apply(painted.with_entries(self.table, entries), gesture, label)

    def undo(self) -> Step:
        """Show the state before."""
        self._gesture, self._is_checked = None, False
        return self._history.undo()

    def redo(self) -> Step:
        """Show the state after."""
        self._gesture, self._is_checked = None, False
        return self._history.redo()

    def save(self, path: Path | None = None) -> None:
        """Write the design file, complete or not at all, and drop the autosave.

        Raises
        ------
        OutputError
            The file cannot be written; the document stays unsaved.
        """
        text = self.text
        write_file(path or self.path, text)
        if self._has_autosave:
            self.autosave_path.unlink(missing_ok=True)
            self._has_autosave = False
        self.path = path or self.path
        self._texts = {self.revision: text} | ({0: self._texts[0]} if 0 in self._texts else {})
        self._saved_revision = self.revision

    def autosave(self) -> None:
        """Keep unsaved work beside the design file; without any, take the autosave of this session away.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        if not self.is_saved and self.history.position:
            write_file(self.autosave_path, self.text)
            self._has_autosave = True
        elif self._has_autosave:
            self.autosave_path.unlink(missing_ok=True)
            self._has_autosave = False

    def recover(self) -> None:
        """Show the work that a former session left.

        Raises
        ------
        DesignError
            It is not a design that can be printed.
        """
        if self.kept_work is not None:
            self.apply(self.kept_work, None, "recovered")
            self.kept_work = None

    def discard(self) -> None:
        """Forget the work that a former session left."""
        self.kept_work = None
        if not self._has_autosave:
            self.autosave_path.unlink(missing_ok=True)

    def _read_autosave(self) -> dict[str, Any] | None:
        try:
            table = tomllib.loads(self.autosave_path.read_text(encoding="utf-8"))
            Design.from_dict(table, self.path.parent)
        except (OSError, ValueError):
            return None
        return table

    def read_again(self, text: str) -> None:
        """Show a new text of the design file: somebody has edited it with another program.

        Raises
        ------
        DesignError
            The text is not a design that can be printed; the document stays as it is.
        """
        table = read_table(self.path)
        self.apply(table, None, "file")
        self.end_gesture()
        self._texts[self.revision] = text
        self._saved_revision = self.revision
