"""One page that is open: what waits to be sent to it."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from typing import Any, Protocol

from asterism.studio import frames

# Text messages that may wait for a page that does not read; a page that falls further behind is closed.
MAX_WAITING = 500


class PageSocket(Protocol):
    """The connection to a page."""

    async def send_text(self, text: str) -> None: ...
    async def send_bytes(self, frame: bytes) -> None: ...


class Tab:
    """Sends messages in order, and shapes one at a time: the newest one when the page has drawn the last.

    Parameters
    ----------
    meshes : packed meshes by their number, shared by all tabs.
    """

    def __init__(self, number: int, meshes: Mapping[int, bytes]) -> None:
        self.number = number
        self.gesture: int | None = None
        self._meshes = meshes
        self._known: set[int] = set()
        self._texts: list[str] = []
        self._shape: tuple[dict[str, Any], dict[str, Any], int] | None = None
        self._in_flight: int | None = None
        self._frame = 0
        self._seq = 0
        self._wake = asyncio.Event()
        self.is_behind = False

    def send(self, message: Mapping[str, Any]) -> None:
        """Send a message; it gets this tab's next sequence number."""
        self._seq += 1
        self._texts.append(json.dumps({**message, "seq": self._seq}, allow_nan=False, default=str))
        self.is_behind = len(self._texts) > MAX_WAITING
        self._wake.set()

    def show(self, mesh: int, header: dict[str, Any], arrays: dict[str, Any], kind: int = frames.SHAPE) -> None:
        """Show a shape. It replaces one that still waits, unless that is a comparison."""
        self._shape = ({**header, "mesh": mesh, "kind": kind}, arrays, mesh)
        self._wake.set()

    def acknowledge(self, frame: int) -> None:
        """The page has drawn a frame."""
        if self._in_flight is not None and frame >= self._in_flight:
            self._in_flight = None
            self._wake.set()

    async def serve(self, socket: PageSocket) -> None:
        """Send what waits, until the connection ends."""
        while not self.is_behind:
            await self._wake.wait()
            self._wake.clear()
            while self._texts:
                await socket.send_text(self._texts.pop(0))
            if self._shape is None or self._in_flight is not None:
                continue
            header, arrays, mesh = self._shape
            self._shape = None
            if mesh not in self._meshes:
                continue
            if mesh not in self._known:
                await socket.send_bytes(self._meshes[mesh])
                self._known = {known for known in self._known if known in self._meshes} | {mesh}
            self._frame += 1
            self._in_flight = self._frame
            kind = header.pop("kind")
            await socket.send_bytes(frames.pack(kind, {**header, "frame": self._frame}, arrays))
            self._wake.set()
