"""What the studio does with the result of a fit: one undo step, and the target in the pose of the fit."""

from __future__ import annotations

import asyncio
from typing import Any, Protocol

from asterism.pattern.design.files import plain
from asterism.studio.document import Document
from asterism.studio.frame_parts import FrameParts
from asterism.studio.job_messages import Fitted
from asterism.studio.page_data import failure_data

FIT_LABEL = "fit to the target"
OTHER_DESIGN = "the fit is left out: another design was opened meanwhile"


class FitOwner(Protocol):
    """The part of the studio that `FitResult` uses."""

    document: Document | None
    lock: asyncio.Lock
    parts: FrameParts

    def tell(self, message: dict[str, Any]) -> None: ...
    async def accept(self, snapshot: bytes | None = None) -> None: ...


class FitResult:
    """Takes the result of a fit for the design that it was started for."""

    def __init__(self, studio: FitOwner) -> None:
        self._studio = studio
        self._document: Document | None = None
        self._version = -1  # of the target
        self._taking: asyncio.Task[None] | None = None

    async def stop(self) -> None:
        """Wait for the result that is being taken."""
        if self._taking is not None:
            await self._taking

    def begin(self, document: Document) -> None:
        """A fit has been started for a document and the target of now."""
        self._document, self._version = document, self._studio.parts.version

    def take(self, fitted: Fitted) -> None:
        """Show the fitted design when no request is being worked on."""
        self._taking = asyncio.create_task(self._take(fitted))

    async def _take(self, fitted: Fitted) -> None:
        studio = self._studio
        async with studio.lock:
            document = studio.document
            if document is None or document is not self._document:
                studio.tell({"type": "note", "text": OTHER_DESIGN})
                studio.tell({"type": "result", "job": "fit", "failed": True})
                return
            before = document.revision
            try:
                await self._show(fitted, document)
                result = {"revision": document.revision, "summary": plain(fitted.summary)}
            except Exception as error:  # nobody waits for this task: the page is where it can be seen
                if document.revision != before:
                    document.take_back()
                studio.tell({**failure_data(error, document.layout, "the result of a fit"), "job": "fit"})
                result = {"failed": True}
            studio.tell({"type": "result", "job": "fit", **result})

    async def _show(self, fitted: Fitted, document: Document) -> None:
        await asyncio.to_thread(document.end_gesture)
        name = document.table.get("name", fitted.table["name"])
        document.apply({**fitted.table, "name": name}, None, FIT_LABEL)
        await self._studio.accept()
        self._studio.parts.pose(fitted, self._version)
