"""What an engine has been asked for and has not begun yet; the newest edit replaces older ones."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from asterism.studio.messages import Cancel, Edit, Parts, Stop


def merged(known: Edit, new: Edit) -> Edit:
    """A new edit; what it leaves out is as in an earlier one, also the form, unless another design is opened."""
    fields = ("design", "sites", "sizes_mm", "removed")
    kept = {name: getattr(known, name) for name in fields if getattr(new, name) is None}
    return replace(new, snapshot=new.snapshot if new.is_opened else known.snapshot, **kept)


class Inbox:
    """Messages that wait, in their order; of edits that follow each other only the newest waits.

    `Parts` comes when no edit waits, and never ends a search.

    Parameters
    ----------
    receive : returns the next message, and raises `EOFError` or `OSError` at the end. It is called in a thread.
    """

    def __init__(self, receive: Callable[[], Any]) -> None:
        self._waiting: deque[Any] = deque()
        self._parts: Parts | None = None
        self._cancelled = -1
        self._is_closed = False
        self._changed = threading.Condition()
        threading.Thread(target=self._read, args=(receive,), daemon=True).start()

    def _read(self, receive: Callable[[], Any]) -> None:
        try:
            while True:
                message = receive()
                if isinstance(message, Stop):
                    break
                self._put(message)
        except (EOFError, OSError):
            pass
        with self._changed:
            self._is_closed = True
            self._changed.notify_all()

    def _put(self, message: Any) -> None:
        with self._changed:
            if isinstance(message, Cancel):
                self._cancelled = max(self._cancelled, message.seq)
            elif isinstance(message, Parts):
                self._parts = message
            elif isinstance(message, Edit) and self._waiting and isinstance(self._waiting[-1], Edit):
                is_opened = message.is_opened or self._waiting[-1].is_opened
                self._waiting[-1] = replace(merged(self._waiting[-1], message), is_opened=is_opened)
            else:
                self._waiting.append(message)
            self._changed.notify_all()

    def take(self, seconds: float | None = None) -> Any:
        """The next message; None after so many seconds without one, or at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._parts or self._is_closed, seconds)
            if self._is_closed:
                return None
            parts = self._parts
            if parts is not None and not (self._waiting and isinstance(self._waiting[0], Edit)):
                self._parts = None
                return parts
            return self._waiting.popleft() if self._waiting else None

    @property
    def is_closed(self) -> bool:
        """Nobody asks any more."""
        return self._is_closed

    @property
    def has_waiting(self) -> bool:
        """Whether a message waits."""
        return bool(self._waiting)

    @property
    def has_waiting_edit(self) -> bool:
        """Whether an edit waits, which makes the work on an earlier one useless."""
        with self._changed:
            return any(isinstance(message, Edit) for message in self._waiting)

    def is_cancelled(self, seq: int) -> bool:
        """Whether the work on a message was broken off."""
        return seq <= self._cancelled
