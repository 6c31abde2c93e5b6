"""The document of the studio: a design file's table with undo and saved state."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asterism.pattern.design.design import Design
from asterism.pattern.design.entries import with_entries
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import read_table, table_text
from asterism.pattern.design.section import Point
from asterism.pattern.design.stars import RodSizeKey, Site
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.results.files import write_file
from asterism.studio import star_sizes
from asterism.studio.autosave import Autosave, autosaves
from asterism.studio.design_file import DesignTexts, check_replaceable, file_text
from asterism.studio.file_names import check_files
from asterism.studio.history import History, Step
from asterism.studio.painted_field import Brush, PaintedField

_numbers = itertools.count(1)


class Document:
    """A design that is being edited.

    Every change gives a new table, which is checked by the project's own parser before it replaces the old one. Changes
    of one gesture are one step of undo.

    Attributes
    ----------
    number : of this document, unlike that of any other one of the session; a saved copy goes on under it.
    path : the design file; it need not exist yet.
    history : the states before and after.
    layout : of the last table that was laid out, see `check`.
    autosave : unsaved work of this session and of a former one.
    """

    def __init__(
        self, table: Mapping[str, Any], path: Path, text: str | None = None, autosave: Autosave | None = None
    ) -> None:
        self.number, self.path = next(_numbers), path
        self.history = History(dict(table))
        self._gesture: Any = None
        self._texts = DesignTexts(text)
        self._is_checked = False
        # revision, size and field of the last stroke: the next one goes on from values that are not rounded
        self._painted: tuple[int, str, PaintedField | None] = (-1, "", None)
        self.autosave = autosave or Autosave(path)
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
        return cls(table, path, file_text(path))

    @classmethod
    def unsaved(cls, path: Path) -> Document:
        """The document of a design that was never saved, from its autosave.

        Raises
        ------
        DesignError
            There is no autosave, or it is not a design that can be printed.
        """
        last = max(autosaves(path), key=lambda file: file.lstat().st_mtime, default=path)
        return cls(read_table(last), path, autosave=Autosave(path, last))

    @classmethod
    def copy_of(cls, source: Path, path: Path) -> Document:
        """A new document, to be saved as `path`, with the text of another design file."""
        document = cls(read_table(source), path)
        document._texts = DesignTexts(file_text(source), is_on_disk=False)
        return document

    @property
    def table(self) -> dict[str, Any]:
        """The table of the design file, as it is shown."""
        return self.history.shown.table

    @property
    def revision(self) -> int:
        """Number of the state that is shown."""
        return self.history.shown.revision

    @property
    def is_saved(self) -> bool:
        """Whether the file is there and holds this state."""
        return self.revision == self._texts.saved_revision and self.path.exists()

    @property
    def text(self) -> str:
        """The text of the design file. A state that was read from a file gives that file's text, byte for byte."""
        return self._texts.text(self.revision, self.table, self.path)

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
            The stars or rods do not fit the sheet, or the outline cannot be cut.
        """
        design = self.design()
        self.layout = layout(design)
        self.hole_rings = [len(hole.rings_mm) or 1 for hole in design.border.holes]
        self._is_checked = True
        self.history.add_plan(self.layout)
        return self.layout

    def apply(self, table: dict[str, Any], gesture: Any, label: str = "") -> None:
        """Show another table: as a new step, or in place of the last one if the gesture is the same.

        Raises
        ------
        DesignError
            A value is out of range; the document stays as it is.
        """
        Design.from_dict(table, self.path.parent)
        if gesture is not None and gesture == self._gesture:
            self.history.replace(table)
        else:
            self.history.push(table, label)
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
        self.history.drop()
        self._gesture = None
        self.check()

    def call_off(self, gesture: Any) -> None:
        """Forget the changes of a gesture that has not ended."""
        if gesture is not None and gesture == self._gesture:
            self.take_back()

    def change(self, changes: Mapping[str, Any], gesture: Any = None) -> None:
        """Other values at dotted keys of the design file; see `with_entries`."""
        changed = with_entries(self.table, changes)
        check_files(dict(changes), self.path.parent)
        self.apply(changed, gesture)

    def paint(self, sites: Sequence[Site], sizes: Mapping[str, Sequence[float | None]], gesture: Any) -> None:
        """Other sizes (mm) of stars at lattice sites."""
        self.apply(star_sizes.painted(self.table, self.layout, sites, sizes), gesture)

    def brush(self, key: RodSizeKey, brush: Brush, places: Sequence[Sequence[Point]], gesture: Any = None) -> None:
        """Paint a size of the rods, see `PaintedField.brushed`. The design file keeps 256 values of it.

        Raises
        ------
        DesignError
            The pattern has no rods, or a value is out of range; the document stays as it is.
        """
        revision, known_key, field = self._painted
        if (revision, known_key) != (self.revision, key) or field is None:
            rods = self.design().rods
            if rods is None:
                raise DesignError("rods", "is missing: the brush paints sizes of rods")
            field = PaintedField.of(getattr(rods, key), self.layout.outline)
        before, field = field, field.brushed(brush, places)
        if np.array_equal(field.values, before.values):
            return  # beside the sheet: no step of undo
        self.apply({**self.table, "rods": {**self.table["rods"], key: field.profile}}, gesture)
        self._painted = self.revision, key, field

    def weigh(self, sites: Sequence[Site], values: Sequence[float | None], gesture: Any = None) -> None:
        """Other weights of places in a fit, at lattice sites; None takes a weight away."""
        self.apply(star_sizes.weighed(self.table, sites, values), gesture)

    def undo(self) -> Step:
        """Show the state before."""
        return self.go(self.history.position - 1)

    def redo(self) -> Step:
        """Show the state after."""
        return self.go(self.history.position + 1)

    def go(self, position: int) -> Step:
        """Show the state at a position of the history."""
        self._gesture, self._is_checked = None, False
        return self.history.go(position)

    def save(self, path: Path | None = None, over: bool = False) -> None:
        """Write the design file, complete or not at all, and drop the autosave.

        Parameters
        ----------
        over : also over a text that the document has not read.

        Raises
        ------
        KeptFileError
            The file holds such a text, or is read-only.
        OutputError
            The file cannot be written; the document stays unsaved.
        """
        path = path or self.path
        if not over:
            check_replaceable(path, self._texts.on_disk if path == self.path else None)
        if not over and self.is_saved and path == self.path and path.exists():
            self.autosave.drop()
            return
        is_same_format = path.suffix.lower() == self.path.suffix.lower()
        text = self.text if is_same_format else table_text(self.table, path)
        write_file(path, text)
        self.autosave.drop()
        if not is_same_format:
            self._texts.forget()
        self.path = self.autosave.design_path = path
        self._texts.keep(self.revision, text)

    def keep_work(self) -> None:
        """Keep unsaved work beside the design file; without any, take the autosave of this session away.

        Raises
        ------
        OutputError
            The file cannot be written.
        """
        if not self.is_saved and (self.history.position or self.autosave.is_written or self._texts.on_disk is not None):
            self.autosave.write(self._texts.edited(self.table, Path("autosave.toml"), self.path))
        else:
            self.autosave.drop()

    def recover(self, name: str | None = None) -> None:
        """Show the work that another session left: that in the autosave of a name, or the last one.

        Raises
        ------
        DesignError
            It is not a design that can be printed.
        OutputError
            It cannot be kept as work of this session; it stays where it is.
        """
        for kept in [kept for kept in self.autosave.kept if name in (None, kept.path.name)][:1]:
            self.apply(kept.table, None, "Recovered")
            self.keep_work()
            self.autosave.forget(kept.path.name)

    def read_again(self) -> None:
        """Show the text of the design file: somebody has edited it with another program.

        Raises
        ------
        DesignError
            The text is not a design that can be printed; the document stays as it is.
        """
        text, table = file_text(self.path), read_table(self.path)
        self.apply(table, None, "Changed on disk")
        self.end_gesture()
        self._texts.keep(self.revision, text)
