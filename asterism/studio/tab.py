"""The pages that are open, and what waits to be sent to each."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator, Mapping
from typing import Any, Protocol

from asterism.studio import frames

# Pages that may be open at the same time.
MAX_TABS = 50
# number of a mesh, header and arrays of a frame on it
Shape = tuple[int, dict[str, Any], dict[str, Any]]


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
        self.is_smooth = False  # it shows the sheet without bumps
        self._meshes = meshes
        self._known: set[int] = set()
        self._texts: list[str] = []
        self._shape: Shape | None = None
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

    def show(self, mesh: int, header: dict[str, Any], arrays: dict[str, Any]) -> None:
        """Show a shape. It replaces one that still waits."""
        self._shape = mesh, header, arrays
        self._wake.set()

    def forget_shape(self) -> None:
        """Another design is open: a shape that waits is not sent."""
        self._shape = None

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
            if self._in_flight is None and (waiting := self._shape) is not None:
                self._shape = None
                await self._draw(socket, waiting)

    async def _draw(self, socket: PageSocket, waiting: Shape) -> None:
        """Send a shape, and its mesh before it if the page does not have it."""
        mesh, header, arrays = waiting
        if mesh not in self._meshes:
            self._wake.set()
            return
        if mesh not in self._known:
            self._known = {known for known in self._known if known in self._meshes} | {mesh}
            await socket.send_bytes(self._meshes[mesh])
        self._frame += 1
        self._in_flight = self._frame
        await socket.send_bytes(frames.pack(frames.SHAPE, {**header, "mesh": mesh, "frame": self._frame}, arrays))


class Tabs:
    """All pages that are open.

    Parameters
    ----------
    meshes : packed meshes by their number.
    """

    def __init__(self, meshes: Mapping[int, bytes]) -> None:
        self._meshes = meshes
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
        tab = self._open[self._last] = Tab(self._last, self._meshes)
        return tab

    def leave(self, tab: Tab) -> None:
        """A page is closed."""
        self._open.pop(tab.number, None)

    def tell(self, message: Mapping[str, Any]) -> None:
        """Send a message to all pages."""
        for tab in self:
            tab.send(message)
