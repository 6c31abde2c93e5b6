"""The studio: one document, its engine, its jobs, and the pages that show it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import Any

from asterism.equilibrium.errors import Error
from asterism.studio import requests as ask
from asterism.studio.apply_gesture import apply_gesture
from asterism.studio.document import Document
from asterism.studio.drawing import Drawings
from asterism.studio.engine_link import EngineLink
from asterism.studio.engine_requests import EngineRequests
from asterism.studio.examples import MAX_FILES, design_files, gallery_entries
from asterism.studio.fit_result import FitResult
from asterism.studio.frame_parts import FrameParts
from asterism.studio.gesture_requests import GestureRequest
from asterism.studio.job_requests import JobRequests
from asterism.studio.local_files import shown_path
from asterism.studio.opening import design_path, opened
from asterism.studio.page_data import document_data, failure_data, opening_problem_data, problem_data
from asterism.studio.printers import DEFAULT_PRINTER, known_printer
from asterism.studio.request import Request, RequestError
from asterism.studio.shown import Shown
from asterism.studio.slots import Slots
from asterism.studio.tab import Tab, Tabs
from asterism.studio.upkeep import Upkeep

MAX_QUEUED = 1000
OTHER_DESIGN = "another design is open now; what was asked for the one before is left out"


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
        self.tabs = Tabs(self.shown.meshes)
        self.lock = asyncio.Lock()
        self._make_engine = make_engine
        self._queue: asyncio.Queue[tuple[Tab, str]] = asyncio.Queue(MAX_QUEUED)
        self._upkeep = Upkeep(self)
        self._left: dict[Path, Document] = {}
        self.printer = DEFAULT_PRINTER
        self.slots = Slots()
        self.drawings = Drawings()
        self.parts = FrameParts(self)
        self.fits = FitResult(self)

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
        await self.fits.stop()
        await self._upkeep.stop()
        self.jobs.close()
        self.engine.link.close()

    def unsaved_work(self) -> list[Path]:
        """Autosaves of the documents of this session that hold more than their files."""
        last = {} if self.document is None else {self.document.path: self.document}
        documents = {**self._left, **last}.values()
        return [one.autosave.path for one in documents if not one.is_saved and one.autosave.path.exists()]

    # pages

    async def receive(self, tab: Tab, text: str) -> None:
        """A page has sent a message."""
        await self._queue.put((tab, text))

    def tell(self, message: dict[str, Any]) -> None:
        """Send a message to all pages."""
        self.tabs.tell(message)

    def tell_state(self) -> None:
        """Send the message `state` to all pages."""
        self.tell(self._state())

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
            "slots": self.slots.data(),
            "target": self.parts.data(),
            "jobs": self.jobs.data(),
        }

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
            tab.send(failure_data(error, layout, "a request of a page", seq))

    async def _answer(self, tab: Tab, request: Request) -> None:
        """Do what a page asks for."""
        match request:
            case ask.Acknowledge():
                tab.acknowledge(request.frame)
            case ask.Hello():
                await self._greet(tab)
            case ask.Gallery():
                tab.send(await asyncio.to_thread(self._gallery))
            case ask.Open() | ask.New():
                await self._open(request)
            case ask.CancelRequest():
                self.jobs.cancel()
            case ask.StopRequest():
                self.engine.link.stop()
            case ask.BumpsRequest():
                self.parts.show_bumps(tab, request.shown)
            case _:
                await self._answer_about(self.open_document(request.document), tab, request)

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
            raise RequestError(OTHER_DESIGN)
        return self.document

    async def _answer_about(self, document: Document, tab: Tab, request: Request) -> None:
        """Do what a page asks for with the open document."""
        match request:
            case ask.TargetRequest():
                self.parts.place(request)
            case GestureRequest():
                await self._gesture(tab, request, document)
            case _:
                await asyncio.to_thread(document.end_gesture)
                await self._command(tab, request, document)

    async def _command(self, tab: Tab, request: Request, document: Document) -> None:
        """A request that is no gesture; the document is laid out."""
        match request:
            case ask.HistoryRequest():
                tab.send({"type": "history", "states": document.thumbnails.data(document.history)})
            case ask.Undo() | ask.Redo() | ask.Go():
                if isinstance(request, ask.Go):
                    step = document.go(request.position)
                else:
                    step = document.undo() if isinstance(request, ask.Undo) else document.redo()
                await self.accept(self.shown.snapshots.get(step.revision))
            case ask.Recover():
                if request.type == "recover":
                    document.recover()
                    await self.accept()
                else:
                    document.autosave.discard()
                    self.tell_document()
            case ask.Save():
                path = design_path(self.folder, request.name) if request.name else None
                await asyncio.to_thread(document.save, path, request.over)
                self._upkeep.begin(document)
                self.tell({"type": "saved", "path": shown_path(document.path)})
                self.tell_document()
            case ask.Reread():
                await asyncio.to_thread(document.read_again)
                await self.accept()
            case ask.FlipRequest() | ask.FormRequest():
                self.engine.search(request)
            case ask.SlotRequest():
                await self._slot(request, document)
            case ask.PrinterRequest():
                self.printer = known_printer(request.name)
                self.tell_document()
            case _:
                self.jobs.start(request, document)
                self.tell_state()

    async def _greet(self, tab: Tab) -> None:
        if self.document is None:
            tab.send(await asyncio.to_thread(self._gallery))
        else:
            tab.send({**document_data(self.document, self.printer, self.engine.limits), "gesture": None})
            self.shown.greet(tab)
        tab.send(self._state())

    async def _open(self, request: ask.Open | ask.New) -> None:
        await self._upkeep.keep_work()
        if self.document is not None:
            self._left[self.document.path] = self.document
        self.document = document = await asyncio.to_thread(opened, self.folder, request)
        self.shown.clear()
        self.slots = Slots()
        self.engine.forget()
        self.parts.forget_target()
        for tab in self.tabs:
            tab.gesture = None
            tab.forget_shapes()
        self._show_document(document)
        self.tell_document()
        self.tell_state()

    async def _gesture(self, tab: Tab, request: GestureRequest, document: Document) -> None:
        """A change of the document; at the end of the gesture the sheet is laid out."""
        gesture = None if request.gesture is None else (tab.number, request.gesture)
        try:
            if note := apply_gesture(request, document, gesture, self.drawings):
                self.tell({"type": "note", "text": note})
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
        self.tell_document()
        self.engine.show(document)

    async def accept(self, snapshot: bytes | None = None) -> None:
        """The document shows a state that no gesture has made, in the form of a snapshot or a fresh one."""
        assert self.document is not None
        await asyncio.to_thread(self.document.end_gesture)
        self.tell_document()
        self.engine.show(self.document, is_opened=True, snapshot=snapshot)

    async def _slot(self, request: ask.SlotRequest, document: Document) -> None:
        if request.type == "show":
            table, snapshot = self.slots.get(request.slot)
            document.apply(table, None, f"show {request.slot}")
            await self.accept(snapshot)
        elif request.type == "keep":
            self.slots.keep(request.slot, document, self.shown)
            self.tell_state()
        else:
            self.slots.drop(request.slot)
            self.tell_state()

    # engine

    def watch_engine(self) -> None:
        """Replace an engine that hangs."""
        self.engine.link.watch()

    def _show_document(self, document: Document) -> None:
        self._upkeep.begin(document)
        self.engine.show(document, is_opened=True)
