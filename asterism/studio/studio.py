"""The studio: one document, its engine, its jobs, and the pages that show it."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asterism.equilibrium.errors import Error
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.results.files import OutputError
from asterism.studio import requests as ask
from asterism.studio.autosave import autosaves
from asterism.studio.design_file import FileWatch
from asterism.studio.document import Document
from asterism.studio.drawing import Drawings, with_drawing
from asterism.studio.engine_link import EngineLink
from asterism.studio.examples import MAX_FILES, design_files, free_name, gallery_entries
from asterism.studio.file_names import file_below, shown_path
from asterism.studio.history import thumbnail
from asterism.studio.jobs import JobRequests
from asterism.studio.messages import Flip, ShowForm
from asterism.studio.page_data import (
    document_data,
    known_printer,
    opening_problem_data,
    problem_data,
)
from asterism.studio.pages import KeptShape, Shown, Tab, Tabs, number_of
from asterism.studio.requests import GestureRequest, Request, RequestError
from asterism.studio.shape_requests import EngineRequests, FrameParts, Settling
from asterism.studio.star_sizes import changed


class Studio:
    """Connects pages, document, engine and jobs; it lives in one event loop.

    Requests are worked on one after the other, so that the document never changes under a request.

    Parameters
    ----------
    folder : of the design; all files that the studio reads and writes are below it.
    path : the design file to open; None shows the gallery.
    make_engine : makes the link to the engine; tests put a quick one in its place.
    """

    def __init__(self, folder: Path, path: Path | None = None, make_engine: Callable[..., EngineLink] = EngineLink):
        self.folder = folder.resolve()
        self.document = Document.open(path) if path is not None else None
        self.shown = Shown()
        self.tabs = Tabs()
        self.lock = asyncio.Lock()
        self._make_engine = make_engine
        self._queue: asyncio.Queue[tuple[Tab, str]] = asyncio.Queue(maxsize=1000)
        self._upkeep = Upkeep(self)
        self._left: dict[Path, Document] = {}
        self._left_shapes: dict[str, KeptShape] = {}  # of the designs that were open, by the names of their files
        self.printer = "ultimaker2"
        self._slots: dict[str, KeptDesign] = {}
        self.drawings = Drawings()
        self.parts = FrameParts(self)
        self.settling = Settling(self)

    async def start(self) -> None:
        """Start the engine and the work on requests; to be called in the event loop."""
        self.engine = EngineRequests(self, self._make_engine)
        self.jobs = JobRequests(self)
        if self.document is not None:
            self._show_document(self.document)
        self._upkeep.start()
        self._working = asyncio.create_task(self._work())

    async def stop(self) -> None:
        """End engine, jobs and requests; unsaved work is kept."""
        self._working.cancel()
        await asyncio.gather(self._working, return_exceptions=True)
        await self.jobs.stop()
        await self._upkeep.stop()
        self.settling.close()
        self.engine.link.close()

    def unsaved_work(self) -> list[Path]:
        """Autosaves of the documents of this session that hold more than their files."""
        last = {} if self.document is None else {self.document.path: self.document}
        documents = {**self._left, **last}.values()
        files = [one.autosave.path for one in documents if not one.is_saved and one.autosave.is_written]
        return [file for file in files if file is not None]

    # pages

    async def receive(self, tab: Tab, text: str) -> None:
        """A page has sent a message."""
        await self._queue.put((tab, text))

    def tell_state(self) -> None:
        """Send the message `state` to all pages."""
        self.tabs.tell(self._state())

    def tell_document(self) -> None:
        """Send the message `document` to all pages, each with the last gesture of its own that it contains."""
        if self.document is not None:
            data = document_data(self.document, self.printer, self.engine.limits)
            for tab in self.tabs:
                tab.send({**data, "gesture": tab.gesture})

    def _state(self) -> dict[str, Any]:
        return {
            "type": "state",
            **self.engine.data(),
            **self.shown.state(),
            "badge": self.badge(),
            "settling": self.settling.data(),
            "settle_s": self.settling.waits_s,
            "release": self.settling.release,
            "unsaved_since": self._upkeep.unsaved_since,
            "slots": {name: self._slots[name].data if name in self._slots else None for name in ("A", "B", "C")},
            "designs": [
                {"name": name, "shape": shape.number, "height_mm": shape.frame.height_mm}
                for name, shape in self._left_shapes.items()
                if self.document is None or name != self.document.path.name
            ],
            "target": self.parts.data(),
            "jobs": self.jobs.data(),
        }

    def badge(self) -> dict[str, Any]:
        """The state of the shown shape, for pages and for the designs that are kept."""
        at_work = self.engine.link.status in ("starting", "computing") or self.settling.data() is not None
        return self.shown.badge(-1 if self.document is None else self.document.revision, at_work)

    def _gallery(self) -> dict[str, Any]:
        files = design_files(self.folder)
        left = max(0, len(files) - MAX_FILES)
        return {
            "type": "gallery",
            "designs": list(gallery_entries()),
            "files": files[:MAX_FILES],
            "files_left_out": left,
        }

    # requests

    async def _work(self) -> None:
        while True:
            tab, text = await self._queue.get()
            async with self.lock:
                await self._answer_or_refuse(tab, text)

    async def _answer_or_refuse(self, tab: Tab, text: str) -> None:
        """Do what a page asks for; whatever goes wrong becomes a message."""
        seq = request = None
        try:
            request = ask.read_request(text)
            seq = request.seq
            await self._answer(tab, request)
        except Exception as error:
            if isinstance(request, ask.Open):
                path = self.folder / request.name if request.name else None
                tab.send(opening_problem_data(error, path, seq))
                return
            layout = None if self.document is None else self.document.layout
            tab.send(problem_data(error, layout, seq))
            tab.send(self._state())  # pages say that a job begins before the server does

    async def _answer(self, tab: Tab, request: Request) -> None:
        """Do what a page asks for."""
        match request:
            case ask.Acknowledge():
                tab.acknowledge(request.frame)
            case ask.Simple(type="hello"):
                await self._greet(tab)
            case ask.Simple(type="gallery"):
                tab.send(await asyncio.to_thread(self._gallery))
            case ask.Open() | ask.Simple(type="new"):
                await self._open(request)
            case ask.Simple(type="cancel"):
                self.jobs.cancel()
            case ask.Simple(type="stop"):
                self.engine.link.stop()
                self.settling.stop()
                self.tell_state()
            case ask.BumpsRequest():
                self.parts.show_bumps(tab, request.shown)
            case _:
                document = self.open_document(request.document)
                match request:
                    case ask.TargetRequest():
                        self.parts.place(request)
                    case GestureRequest():
                        await self._gesture(tab, request, document)
                    case _:
                        await asyncio.to_thread(document.end_gesture)
                        await self._command(tab, request, document)

    def open_document(self, number: int | None) -> Document:
        """The open document, for a request about the document of a number; without one, about whichever is open.

        Raises
        ------
        RequestError
            Another document is open, or none.
        """
        if self.document is None:
            raise RequestError("open a design first")
        if number not in (None, self.document.number):
            raise RequestError("another design is open now; what was asked for the one before is left out")
        return self.document

    async def _command(self, tab: Tab, request: Request, document: Document) -> None:
        """A request that is no gesture; the document is laid out."""
        match request:
            case ask.Simple(type="kept"):
                tab.send({"type": "kept", "states": await asyncio.to_thread(kept_states, document)})
            case ask.Simple(type="history"):
                tab.send({"type": "history", "states": document.history.data()})
            case ask.Simple(type="undo" | "redo") | ask.Go():
                if isinstance(request, ask.Go):
                    step = document.go(request.position)
                else:
                    step = document.undo() if request.type == "undo" else document.redo()
                await self.accept(self.shown.snapshots.get(step.revision))
            case ask.Recover():
                if request.type == "recover":
                    await asyncio.to_thread(document.recover, request.name)
                    await self.accept()
                else:
                    document.autosave.forget(request.name)
                    self.tell_document()
            case ask.Save():
                path = design_path(self.folder, request.name) if request.name else None
                await asyncio.to_thread(document.save, path, request.over)
                self._upkeep.begin(document)
                self.tabs.tell({"type": "saved", "path": shown_path(document.path)})
                self.tell_document()
            case ask.Simple(type="reread"):
                await asyncio.to_thread(document.read_again)
                await self.accept()
            case ask.Simple(type="flip"):
                self.engine.search(Flip)
            case ask.FormRequest():
                self.engine.search(ShowForm, request.index)
            case ask.ExactFormRequest():
                self.settling.show_form(request.released)
                self.tell_state()
            case ask.SlotRequest():
                await self._slot(request, document)
            case ask.PrinterRequest():
                self.printer = known_printer(request.name)
                self.tell_document()
            case ask.Simple(type="settle" | "verify" as kind) if kind == "settle" or not self.shown.has_preview:
                self.settling.begin()
                self.tell_state()
            case _:
                self.jobs.start(request, document)
                self.tell_state()

    async def _greet(self, tab: Tab) -> None:
        if self.document is None:
            tab.send(await asyncio.to_thread(self._gallery))
        else:
            tab.send({**document_data(self.document, self.printer, self.engine.limits), "gesture": None})
            for problem in self.document.autosave.problems:
                tab.send({"type": "note", "text": problem})
            self.shown.greet(tab)
        tab.send(self._state())

    async def _open(self, request: ask.Open | ask.Simple) -> None:
        await self._upkeep.keep_work()
        if self.document is not None:
            self._left[self.document.path] = self.document
            self._keep_left(self.document.path)
        self.document = document = await asyncio.to_thread(opened, self.folder, request)
        self.settling.cancel()
        self.shown.clear()
        self._slots.clear()
        self.engine.forget()
        self.parts.forget_target()
        for tab in self.tabs:
            tab.gesture = None
            tab.forget_shape()
        self._show_document(document)
        for tab in self.tabs:
            await self._greet(tab)

    def _keep_left(self, path: Path) -> None:
        """Keep the shape of a design that makes way for another one, if it can be opened again."""
        shape = self.shown.keep_shown()
        if shape is not None and path.resolve().parent == self.folder and (path.exists() or autosaves(path)):
            others = [left for left in self._left_shapes.items() if left[0] != path.name]
            self._left_shapes = dict([(path.name, shape), *others][:6])  # those that are shown, the last one first

    async def _gesture(self, tab: Tab, request: GestureRequest, document: Document) -> None:
        """A change of the document; at the end of the gesture the sheet is laid out."""
        gesture = None if request.gesture is None else (tab.number, request.gesture)
        try:
            if note := apply_gesture(request, document, gesture, self.drawings):
                self.tabs.tell({"type": "note", "text": note})
        except Error as error:
            tab.send(problem_data(error, document.layout, request.seq))
        tab.gesture = request.gesture
        if not request.end and gesture is not None:
            self.engine.show(document, is_dragging=True)
            return
        try:
            await asyncio.to_thread(document.end_gesture)
        except Error as error:
            tab.send(problem_data(error, document.layout, request.seq))
        self.engine.show(document)  # before the document, so that pages do not say of it what they said of the last one
        self.tell_document()

    async def accept(self, snapshot: bytes | None = None) -> None:
        """The document shows a state that no gesture has made, in the form of a snapshot or a fresh one."""
        assert self.document is not None
        await asyncio.to_thread(self.document.end_gesture)
        self.engine.show(self.document, is_opened=True, snapshot=snapshot)
        self.tell_document()

    async def _slot(self, request: ask.SlotRequest, document: Document) -> None:
        """Keep the design with its shape and numbers in a slot, or show the one that is there."""
        if request.type == "show":
            if request.slot not in self._slots:
                raise RequestError(f"slot {request.slot} is empty: keep a design there first")
            kept = self._slots[request.slot]
            document.apply(kept.table, None, f"Design {request.slot}")
            await self.accept(kept.snapshot)
            return
        numbers = {key: self.shown.numbers.get(key) for key in ("height_mm", "extent_mm")}
        numbers["state"] = self.badge()["words"]
        self._slots[request.slot] = KeptDesign(
            document.table, self.shown.snapshots.get(document.revision), self.shown.keep_shown(), numbers
        )
        self.tell_state()

    def _show_document(self, document: Document) -> None:
        self._upkeep.begin(document)
        self.engine.show(document, is_opened=True)


@dataclass(frozen=True)
class KeptDesign:
    """A design that is kept as A, B or C."""

    table: dict[str, Any]
    snapshot: bytes | None  # its form, as in a frame
    shape: KeptShape | None  # as it was shown
    numbers: dict[str, Any]  # of the shape

    @property
    def data(self) -> dict[str, Any]:
        """The slot for the message `state`."""
        return {**self.numbers, "shape": number_of(self.shape)}


class Upkeep:
    """What the studio does by itself: autosave, following the design file, watching the engine."""

    def __init__(self, studio: Studio) -> None:
        self._studio = studio
        self._watch: FileWatch | None = None
        self._autosaved: int | None = None
        self._is_gone = False  # the design file, after it was there
        self.unsaved_since: float | None = None  # s since 1970; an autosave has failed since
        self._busy = asyncio.Lock()
        self._tasks: list[asyncio.Task[None]] = []

    def start(self) -> None:
        """Begin; to be called in the event loop."""
        for work, seconds in ((self._autosave, 1.0), (self._follow, 0.5)):
            self._tasks.append(asyncio.create_task(self._repeat(work, seconds)))

    async def stop(self) -> None:
        """End, and keep unsaved work."""
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self.keep_work()

    def begin(self, document: Document) -> None:
        """Another document is open, or the document has been saved: its file and revision are the known ones."""
        self._watch = FileWatch(document.path)
        self._autosaved = document.revision
        self._is_gone = not document.path.exists()
        self.unsaved_since = None

    async def keep_work(self) -> None:
        """Write the autosave if there is something to keep."""
        document = self._studio.document
        if document is None:
            return
        failed = self.unsaved_since
        try:
            async with self._busy:
                await asyncio.to_thread(document.keep_work)
            self._autosaved, self.unsaved_since = document.revision, None
        except (OutputError, OSError) as error:
            self._autosaved, self.unsaved_since = None, failed or time.time()  # it is tried again
            if failed is None:
                self._studio.tabs.tell(problem_data(error, None))
        if failed != self.unsaved_since:
            self._studio.tell_state()

    async def _repeat(self, work: Callable[[], Awaitable[None]], seconds: float) -> None:
        known = ""
        while True:
            await asyncio.sleep(seconds)
            try:
                await work()
            except Exception as error:
                if repr(error) != known:  # the same mistake would come again every time
                    known = repr(error)
                    self._studio.tabs.tell(problem_data(error, None, work="upkeep of the studio"))

    async def _autosave(self) -> None:
        self._studio.engine.link.watch()  # an engine that hangs is replaced
        document = self._studio.document
        if document is None:
            return
        is_lost = document.autosave.path is not None and not document.autosave.is_written
        if document.revision != self._autosaved or is_lost:
            await self.keep_work()

    async def _follow(self) -> None:
        """Show what somebody writes into the design file with another program."""
        watch, document = self._watch, self._studio.document
        if document is not None and (is_gone := not document.path.exists()) != self._is_gone:
            self._is_gone, self._autosaved = is_gone, None
            if is_gone:
                note = f"{shown_path(document.path)} was deleted or moved; Save writes it again."
                self._studio.tabs.tell({"type": "note", "text": note})
            self._studio.tell_document()
        if watch is None or document is None or (text := await asyncio.to_thread(watch.changed_text)) is None:
            return
        async with self._studio.lock:
            if document is not self._studio.document or watch is not self._watch or text == document.text:
                return
            try:
                await asyncio.to_thread(document.read_again)
            except Error as error:
                self._studio.tabs.tell(problem_data(error, document.layout))
                return
            self._studio.tabs.tell({"type": "followed", "path": shown_path(document.path)})
            await self._studio.accept()


def opened(folder: Path, request: ask.Open | ask.Simple) -> Document:
    """The document that a request opens.

    Raises
    ------
    RequestError, FileNameError, DesignError
        There is no such design, or its file is not one.
    """
    if isinstance(request, ask.Simple):
        table = {"name": "sheet", "stars": {"length_mm": 8.0, "thickness_mm": 0.3}, "border": {"rings": 3}}
        return Document(table, free_name(folder, "sheet"))
    if request.gallery is not None:
        if request.gallery not in (*gallery.names(), *gallery.pattern_names()):
            raise RequestError(f"{request.gallery!r} is not in the gallery")
        return Document.copy_of(gallery.path(request.gallery), free_name(folder, request.gallery))
    path = design_path(folder, request.name or "")
    return Document.unsaved(path) if not path.exists() and autosaves(path) else Document.open(path)


def kept_states(document: Document) -> list[dict[str, Any]]:
    """Name, time and plan of the unsaved work that other sessions have left on a document."""
    states = []
    for kept in document.autosave.kept:
        plan = {}
        with suppress(Error):  # a sheet that cannot be laid out has no picture
            plan = thumbnail(layout(Design.from_dict(kept.table, document.path.parent)))
        states.append({"name": kept.path.name, "time": kept.time, **plan})
    return states


def design_path(folder: Path, name: str) -> Path:
    """The path of a design file of the folder; a name without an ending is that of a TOML file."""
    return file_below(folder, name if name.endswith((".toml", ".json")) else f"{name}.toml")


def apply_gesture(request: GestureRequest, document: Document, gesture: Any, drawings: Drawings) -> str | None:
    """Change the document; all requests of one gesture are one step of undo. A note for all pages, if there is one.

    Raises
    ------
    Error
        The change is refused; the document stays as it is.
    """
    match request:
        case ask.Change():
            document.change(request.changes, gesture)
        case ask.TakeBack():
            document.call_off(gesture)
        case ask.Paint():
            document.paint(request.sites, request.sizes, gesture)
        case ask.BrushRequest():
            document.brush(request.size, request, request.places, gesture)
        case ask.PlaceDrawing():
            drawing = drawings.get(request.drawing)
            table, note = with_drawing(document.table, drawing, request, document.layout.outline)
            document.apply(table, gesture, drawing.name[:60])
            return note
        case ask.Weigh():
            document.weigh(request.sites, request.weights, gesture)
        case ask.StarsRequest():
            document.apply(changed(document.table, document.layout, request.sites, request.type), gesture)
    return None
