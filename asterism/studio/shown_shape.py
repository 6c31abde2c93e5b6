"""The shape that the page shows: meshes, the last frame, numbers and warnings."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any
from weakref import WeakValueDictionary

from asterism.equilibrium.arrays import Array
from asterism.pattern.design.files import plain
from asterism.results.words import shape_in_words
from asterism.studio import frames
from asterism.studio.frames import frame_parts, mesh_bytes
from asterism.studio.messages import FormShape, Frame, Settled, ShapeSummary, ShownMesh, StudioProblem
from asterism.studio.page_data import engine_problem_data
from asterism.studio.tab import Tab

_kept_numbers = itertools.count(1)


@dataclass(frozen=True, eq=False)
class KeptShape:
    """A shape that pages may ask for by its number, to show it small or beside another one.

    Attributes
    ----------
    mesh : as it is packed.
    header, arrays : of its frame.
    """

    mesh: bytes
    header: dict[str, Any]
    arrays: dict[str, Any]
    number: int = field(default_factory=lambda: next(_kept_numbers))

    def packed(self) -> bytes:
        """The binary frame with the shape and its mesh."""
        return frames.pack(frames.KEPT, self.header, frames.unpack(self.mesh)[2] | self.arrays)


class Shown:
    """Collects what the engine sends, and passes it to the tabs.

    Attributes
    ----------
    meshes : packed meshes by number, the last used one last.
    numbers : of the last shape, for the message `state`.
    has_preview : whether the design has one.
    snapshots : forms by the document's revision, to come back to by undo.
    kept : shapes by their number, as long as somebody holds them.
    """

    def __init__(self) -> None:
        self.meshes: dict[int, bytes] = {}
        self.snapshots: dict[int, bytes] = {}
        self.kept: WeakValueDictionary[int, KeptShape] = WeakValueDictionary()
        self.clear()

    def clear(self) -> None:
        """Forget the shape: another document is open."""
        self.numbers: dict[str, Any] = {}
        self.warnings: list[dict[str, Any]] = []
        self.forms: list[dict[str, Any]] = []
        self._form_shapes: dict[int, KeptShape] = {}  # by the index of the form
        self.problem: dict[str, Any] | None = None
        self.busy: str | None = None
        self.stage: str | None = None
        self.revision: int | None = None
        self.summary_revision: int | None = None
        self._exact: bytes | None = None
        self._exact_seq = -1  # of the engine's last answer before it
        self.has_preview = True
        self._last: tuple[int, dict[str, Any], dict[str, Any]] | None = None
        self.snapshots.clear()

    def exact_of(self, revision: int) -> bytes | None:
        """The shape that is shown, pickled, if it is the exact one of a state of the document."""
        return self._exact if self.revision == revision else None

    def keep(self, mesh: bytes, header: dict[str, Any], arrays: dict[str, Any]) -> KeptShape:
        """A shape for pages, without the preview beside it."""
        own = {name: values for name, values in arrays.items() if not name.startswith("before")}
        shape = KeptShape(mesh, header, own)
        self.kept[shape.number] = shape
        return shape

    def keep_shown(self) -> KeptShape | None:
        """The shape that is shown, for pages to come; None without one."""
        if self._last is None or (mesh := self.meshes.get(self._last[0])) is None:
            return None
        return self.keep(mesh, *self._last[1:])

    def keep_settled(self, settled: Settled) -> KeptShape:
        """An exact shape, for pages."""
        return self.keep(mesh_bytes(settled.mesh), *frame_parts(settled.frame))

    def add_form_shape(self, form: FormShape) -> None:
        """The shape of one of the forms of the last summary."""
        if (mesh := self.meshes.get(form.frame.mesh)) is not None:
            self._form_shapes[form.index] = self.keep(mesh, *frame_parts(form.frame))

    def add_mesh(self, mesh: ShownMesh) -> None:
        """Keep a mesh for the tabs."""
        self.meshes[mesh.mesh] = mesh_bytes(mesh)
        for old in list(self.meshes)[:-6]:
            del self.meshes[old]

    def add_frame(self, frame: Frame, revision: int, tabs: Iterable[Tab]) -> None:
        """Show a shape in all tabs. The preview before an exact shape does not take its place."""
        if self._exact is not None and frame.seq <= self._exact_seq:
            return
        if not frame.is_again:
            self.busy, self.problem, self.summary_revision = None, None, None
        self.has_preview = self.has_preview if frame.stage == "exact" else frame.stage != "printed"
        if frame.stage == "printed" and self.stage == "exact":
            return  # the last exact shape stays until the next one
        self._exact = None
        self.stage, self.revision = frame.stage, revision
        self.numbers = {**self.numbers, "height_mm": float(frame.height_mm), "is_minimum": bool(frame.is_minimum)}
        if frame.snapshot is not None:
            self.snapshots[revision] = frame.snapshot
            for old in list(self.snapshots)[:-50]:
                del self.snapshots[old]
        if frame.mesh in self.meshes:
            self.meshes[frame.mesh] = self.meshes.pop(frame.mesh)  # the last one used goes last
        header, arrays = frame_parts(frame)
        self._last = (frame.mesh, {"revision": revision, **header}, arrays)
        for tab in tabs:
            tab.show(*self._last)

    @property
    def sheet(self) -> tuple[Array, Array] | None:
        """Printed (V, 2) and shown (V, 3) places of the last sheet, mm; None without one."""
        if self._last is None or (packed := self.meshes.get(self._last[0])) is None:
            return None
        return frames.unpack(packed)[2]["printed"], self._last[2]["positions"]

    def add_summary(self, summary: ShapeSummary, revision: int) -> None:
        """Numbers, warnings and forms of a shape."""
        if self._exact is not None and summary.seq <= self._exact_seq:
            return
        self.numbers = plain({**self.numbers, **summary.numbers})
        self.warnings = [asdict(notice) for notice in summary.warnings]
        self.forms, self._form_shapes = [asdict(form) for form in summary.forms], {}
        self.summary_revision = revision

    def add_problem(self, problem: StudioProblem) -> dict[str, Any]:
        """An edit without a shape: the last good one stays. Returns the problem's data."""
        data = engine_problem_data(problem)
        self.problem, self.busy = data, None
        return data

    def show_exact(self, settled: Settled, revision: int, seq: int, tabs: Iterable[Tab]) -> None:
        """Show an exact shape of the document as it is. The forms that its preview could take stay.

        Parameters
        ----------
        seq : of the engine's last answer before it.
        """
        forms, self._exact, self.numbers = (self.forms, self._form_shapes), None, {}
        self.add_mesh(settled.mesh)
        self.add_frame(settled.frame, revision, tabs)
        self.add_summary(settled.shown, revision)
        (self.forms, self._form_shapes), self._exact, self._exact_seq = forms, settled.shape, seq

    def badge(self, revision: int, is_at_work: bool) -> dict[str, Any]:
        """The one statement about the shape, the worst first: its kind, its words, and the frame that it is about.

        Whatever speaks of the shape, on pages and of designs that are kept, takes it from here.

        Parameters
        ----------
        revision : of the document.
        is_at_work : whether a newer shape is on its way.
        """
        is_current = self.revision == revision
        has_shape = is_current and self.stage in ("equilibrium", "exact")
        if not has_shape and is_at_work:
            kind, words = "computing", "Computing"
        elif self.stage == "printed" or self.revision is None:
            kind, words = "none", "Not computed"
        elif not has_shape:
            kind, words = "outdated", "Outdated"
        else:
            model, is_minimum = "exact" if self.stage == "exact" else "preview", bool(self.numbers.get("is_minimum"))
            numbers = {} if self.summary_revision is None else self.numbers
            words = shape_in_words({**numbers, "model": model, "is_minimum": is_minimum})
            kind = model if is_minimum else "doubtful"
        is_stale = self.revision is not None and not is_current
        return {"kind": kind, "words": words, "revision": self.revision, "stage": self.stage, "is_stale": is_stale}

    def greet(self, tab: Tab) -> None:
        """Show the last shape in a tab that has just been opened."""
        if self._last is not None:
            tab.show(*self._last)

    def state(self) -> dict[str, Any]:
        """The shape's part of the message `state`."""
        return {
            "has_preview": self.has_preview,
            "numbers": self.numbers,
            "summary_revision": self.summary_revision,
            "warnings": self.warnings,
            "forms": [form | {"shape": number_of(self._form_shapes.get(form["index"]))} for form in self.forms],
            "problem": self.problem,
            "busy": self.busy,
        }


def number_of(shape: KeptShape | None) -> int | None:
    """The number of a kept shape, for the message `state`."""
    return None if shape is None else shape.number
