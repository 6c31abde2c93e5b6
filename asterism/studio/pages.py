"""The pages that are open, what waits to be sent to each, and the shape that they show."""

from __future__ import annotations

import asyncio
import itertools
import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any
from weakref import WeakValueDictionary

from starlette.websockets import WebSocket

from asterism.equilibrium.arrays import Array
from asterism.pattern.design.files import plain
from asterism.results.words import shape_in_words
from asterism.studio import frames
from asterism.studio.messages import Frame, Settled, ShapeSummary, StudioProblem

# Pages that may be open at the same time.
MAX_TABS = 50
_kept_numbers = itertools.count(1)


class Tab:
    """Sends messages in order, and shapes one at a time: the newest one when the page has drawn the last."""

    def __init__(self, number: int) -> None:
        self.number = number
        self.gesture: int | None = None
        self.is_smooth = False  # it shows the sheet without bumps
        self._known: list[int] = []  # meshes that the page keeps, the last one used last
        self._texts: list[str] = []
        self._shape: tuple[Frame, int] | None = None
        self._in_flight: int | None = None
        self._frame = 0
        self._wake = asyncio.Event()
        self.is_behind = False

    def send(self, message: Mapping[str, Any]) -> None:
        """Send a message."""
        self._texts.append(json.dumps(message, allow_nan=False, default=str))
        # Text messages that may wait for a page that does not read; a page that falls further behind is closed.
        self.is_behind = len(self._texts) > 500
        self._wake.set()

    def show(self, frame: Frame, revision: int) -> None:
        """Show a shape of a state of the document. It replaces one that still waits."""
        self._shape = frame, revision
        self._wake.set()

    def forget_shape(self) -> None:
        """Another design is open: a shape that waits is not sent."""
        self._shape = None

    def acknowledge(self, frame: int) -> None:
        """The page has drawn a frame."""
        if self._in_flight is not None and frame >= self._in_flight:
            self._in_flight = None
            self._wake.set()

    async def serve(self, socket: WebSocket) -> None:
        """Send what waits, until the connection ends."""
        while not self.is_behind:
            await self._wake.wait()
            self._wake.clear()
            while self._texts:
                await socket.send_text(self._texts.pop(0))
            if self._in_flight is None and (waiting := self._shape) is not None:
                self._shape = None
                await self._draw(socket, *waiting)

    async def _draw(self, socket: WebSocket, frame: Frame, revision: int) -> None:
        """Send a shape, and its mesh before it if the page does not have it."""
        if frame.mesh not in self._known:
            await socket.send_bytes(frames.mesh_bytes(frame))
        self._known = [*(number for number in self._known if number != frame.mesh), frame.mesh][-6:]
        self._frame += 1
        self._in_flight = self._frame
        header = {"revision": revision, **frame.header, "mesh": frame.mesh, "frame": self._frame}
        await socket.send_bytes(frames.pack(frames.SHAPE, header, frame.arrays))


class Tabs:
    """All pages that are open."""

    def __init__(self) -> None:
        self._open: dict[int, Tab] = {}
        self._last = 0

    def __iter__(self) -> Iterator[Tab]:
        return iter(list(self._open.values()))

    def __len__(self) -> int:
        return len(self._open)

    def join(self) -> Tab | None:
        """A page is opened; None if there are too many."""
        if len(self) >= MAX_TABS:
            return None
        self._last += 1
        tab = self._open[self._last] = Tab(self._last)
        return tab

    def leave(self, tab: Tab) -> None:
        """A page is closed."""
        self._open.pop(tab.number, None)

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send a message to all pages."""
        for tab in self:
            tab.send(message)


@dataclass(frozen=True, eq=False)
class KeptShape:
    """A shape that pages may ask for by its number, to show it small or beside another one."""

    frame: Frame
    number: int = field(default_factory=lambda: next(_kept_numbers))

    def packed(self) -> bytes:
        """The binary frame with the shape and its mesh, without the preview beside it."""
        arrays = {name: values for name, values in self.frame.arrays.items() if not name.startswith("before")}
        return frames.pack(frames.KEPT, self.frame.header, {**self.frame.mesh_arrays, **arrays})


class Shown:
    """Collects what the engine sends, and passes it to the tabs.

    Attributes
    ----------
    numbers : of the last shape, for the message `state`.
    has_preview : whether the design has one.
    snapshots : forms by the document's revision, to come back to by undo.
    kept : shapes by their number, as long as somebody holds them.
    """

    def __init__(self) -> None:
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
        self._last: Frame | None = None
        self.snapshots.clear()

    def exact_of(self, revision: int) -> bytes | None:
        """The shape that is shown, pickled, if it is the exact one of a state of the document."""
        return self._exact if self.revision == revision else None

    def keep(self, frame: Frame) -> KeptShape:
        """A shape for pages."""
        shape = KeptShape(frame)
        self.kept[shape.number] = shape
        return shape

    def keep_shown(self) -> KeptShape | None:
        """The shape that is shown, for pages to come; None without one."""
        return None if self._last is None else self.keep(self._last)

    def add_form(self, frame: Frame) -> None:
        """The shape of one of the forms of the last summary."""
        assert frame.form is not None
        self._form_shapes[frame.form] = self.keep(frame)

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
        self.numbers = {**self.numbers, "height_mm": frame.height_mm, "is_minimum": frame.is_minimum}
        if frame.snapshot is not None:
            self.snapshots[revision] = frame.snapshot
            for old in list(self.snapshots)[:-50]:
                del self.snapshots[old]
        self._last = frame
        for tab in tabs:
            tab.show(frame, revision)

    @property
    def sheet(self) -> tuple[Array, Array] | None:
        """Printed (V, 2) and shown (V, 3) places of the last sheet, mm; None without one."""
        if self._last is None:
            return None
        return self._last.mesh_arrays["printed"], self._last.arrays["positions"]

    def add_summary(self, summary: ShapeSummary, revision: int) -> None:
        """Numbers, warnings and forms of a shape."""
        if self._exact is not None and summary.seq <= self._exact_seq:
            return
        self.numbers = plain({**self.numbers, **summary.numbers})
        self.warnings = [asdict(notice) for notice in summary.warnings]
        self.forms, self._form_shapes = [asdict(form) for form in summary.forms], {}
        self.summary_revision = revision

    def add_problem(self, problem: StudioProblem) -> None:
        """An edit without a shape: the last good one stays."""
        self.problem, self.busy = problem.data, None

    def show_exact(self, settled: Settled, revision: int, seq: int, tabs: Iterable[Tab]) -> None:
        """Show an exact shape of the document as it is. The forms that its preview could take stay.

        Parameters
        ----------
        seq : of the engine's last answer before it.
        """
        forms, self._exact, self.numbers = (self.forms, self._form_shapes), None, {}
        self.add_frame(settled.frame, revision, tabs)
        self.add_summary(settled.shown, revision)
        (self.forms, self._form_shapes), self._exact, self._exact_seq = forms, settled.shape, seq

    def badge(self, revision: int, is_at_work: bool) -> dict[str, Any]:
        """The one statement about the shape, the worst first: its kind, its words, and the frame that it is about.

        Whatever speaks of the shape, on pages and of designs that are kept, takes it from here. The revision is that of
        the document; `is_at_work` says whether a newer shape is on its way.
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
        if self._last is not None and self.revision is not None:
            tab.show(self._last, self.revision)

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
