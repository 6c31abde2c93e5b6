"""What the studio does by itself: autosave, following the design file, watching the engine."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any, Protocol

from asterism.equilibrium.errors import Error
from asterism.results.files import OutputError
from asterism.studio.document import Document
from asterism.studio.local_files import shown_path
from asterism.studio.page_data import failure_data, problem_data
from asterism.studio.watcher import FileWatch

AUTOSAVE_EVERY_S = 1.0
FOLLOW_EVERY_S = 0.5


class DocumentOwner(Protocol):
    """What the upkeep needs of the studio."""

    document: Document | None
    lock: asyncio.Lock  # held while the document is changed

    def tell(self, message: dict[str, Any]) -> None: ...
    async def accept(self, snapshot: bytes | None = None) -> None: ...
    def watch_engine(self) -> None: ...


class Upkeep:
    """Repeated work on the document that is open.

    Parameters
    ----------
    studio : whose document is kept.
    """

    def __init__(self, studio: DocumentOwner) -> None:
        self._studio = studio
        self._watch: FileWatch | None = None
        self._autosaved: int | None = None
        self._busy = asyncio.Lock()
        self._tasks: list[asyncio.Task[None]] = []

    def start(self) -> None:
        """Begin; to be called in the event loop."""
        for work, seconds in ((self._autosave, AUTOSAVE_EVERY_S), (self._follow, FOLLOW_EVERY_S)):
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

    async def keep_work(self) -> None:
        """Write the autosave if there is something to keep."""
        document = self._studio.document
        if document is None:
            return
        try:
            async with self._busy:
                await asyncio.to_thread(document.keep_work)
        except (OutputError, OSError) as error:
            self._studio.tell(problem_data(error, None))

    async def _repeat(self, work: Callable[[], Awaitable[None]], seconds: float) -> None:
        known = ""
        while True:
            await asyncio.sleep(seconds)
            try:
                await work()
            except Exception as error:
                if repr(error) != known:  # the same mistake would come again every time
                    known = repr(error)
                    self._studio.tell(failure_data(error, None, "upkeep of the studio"))

    async def _autosave(self) -> None:
        self._studio.watch_engine()
        document = self._studio.document
        if document is not None and document.revision != self._autosaved:
            self._autosaved = document.revision
            await self.keep_work()

    async def _follow(self) -> None:
        """Show what somebody writes into the design file with another program."""
        watch, document = self._watch, self._studio.document
        if watch is None or document is None or (text := await asyncio.to_thread(watch.changed_text)) is None:
            return
        async with self._studio.lock:
            if document is not self._studio.document or watch is not self._watch or text == document.text:
                return
            try:
                await asyncio.to_thread(document.read_again)
            except Error as error:
                self._studio.tell(problem_data(error, document.layout))
                return
            self._studio.tell({"type": "followed", "path": shown_path(document.path)})
            await self._studio.accept()
