"""What an engine has been asked for and has not begun yet, and when that ends the work on what came before."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from asterism.previews.session import SearchLimitError
from asterism.studio.messages import Busy, Cancel, Edit, Parts

STALE_S = 0.4  # a search that has taken longer ends when a newer edit waits
MAX_SEARCH_S = 20.0  # processor time of a search, but while the pointer is down
SIGN_EVERY_S = 2.0  # of life, in long searches
MAX_LONG_STEP_S = 30.0  # processor time of a step that is announced, or at rest


class Superseded(Exception):
    """A newer message waits, and the work on an older one ends."""


class Cancelled(Exception):
    """The work on a message was broken off."""


class Inbox:
    """Messages that wait, in their order; of edits that follow each other only the newest waits.

    `Parts` comes when no edit waits, and never ends a search.

    Parameters
    ----------
    receive : returns the next message, and raises `EOFError` or `OSError` at the end. It is called in a thread.

    Attributes
    ----------
    is_closed : nobody asks any more.
    """

    def __init__(self, receive: Callable[[], Any]) -> None:
        self._waiting: deque[Any] = deque()
        self._parts: Parts | None = None
        self._cancelled = -1
        self.is_closed = False
        self._changed = threading.Condition()
        threading.Thread(target=self._read, args=(receive,), daemon=True).start()

    def _read(self, receive: Callable[[], Any]) -> None:
        try:
            while True:
                self._put(receive())
        except (EOFError, OSError):
            pass
        with self._changed:
            self.is_closed = True
            self._changed.notify_all()

    def _put(self, message: Any) -> None:
        with self._changed:
            if isinstance(message, Cancel):
                self._cancelled = max(self._cancelled, message.seq)
            elif isinstance(message, Parts):
                self._parts = message
            else:
                if isinstance(message, Edit) and self._waiting and isinstance(self._waiting[-1], Edit):
                    last = self._waiting.pop()
                    if not message.is_opened:  # a design that waits to be opened is opened, in its form
                        message = replace(message, is_opened=last.is_opened, snapshot=last.snapshot)
                self._waiting.append(message)
            self._changed.notify_all()

    def take(self, seconds: float | None = None) -> Any:
        """The next message; None after so many seconds without one, or at the end."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._parts or self.is_closed, seconds)
            if self.is_closed:
                return None
            parts = self._parts
            if parts is not None and not (self._waiting and isinstance(self._waiting[0], Edit)):
                self._parts = None
                return parts
            return self._waiting.popleft() if self._waiting else None

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


class SearchBounds:
    """Watches the work on one message at a time.

    Attributes
    ----------
    seq : of the message.
    longest_s : processor time that the work may take.
    """

    def __init__(self, inbox: Inbox, send: Callable[[Any], None], clock: Callable[[], float]) -> None:
        self._inbox, self._send, self._clock = inbox, send, clock
        self._was_stale = False
        self.begin(0)

    def begin(self, seq: int, yields: bool = False) -> None:
        """Begin the work on a message; work that yields ends when another one waits, and is not cancelled."""
        self.seq, self.longest_s, self._yields = seq, MAX_SEARCH_S, yields
        self._begun, self.last_sign, self._waits = self._clock(), time.monotonic(), False
        self._start()
        self.go_on()

    def _start(self) -> None:
        """The search begins, or goes on after a long step that does not count."""
        self._searching_from = self._clock()
        self._worked, self._compiled = time.thread_time(), time.perf_counter() - self._clock()

    def wait(self) -> None:
        """A long step begins that is no search, as when cells are solved: its time does not count, until `check`."""
        self._waits = True
        self.go_on(MAX_LONG_STEP_S)

    def go_on(self, step_s: float | None = None) -> None:
        """The work is not stuck: a step begins, which may take so much processor time; at rest, steps are longer.

        What takes longer between two checks counts as a loop without end.
        """
        usual = MAX_LONG_STEP_S if self._yields else 5.0
        self._step_ends = time.process_time() + (usual if step_s is None else step_s)

    @property
    def is_stuck(self) -> bool:
        """Whether a step takes too long; on a busy machine or without a processor it takes no time."""
        return time.process_time() > self._step_ends

    def end(self, is_superseded: bool) -> None:
        """End the work, in favour of a newer message or with an answer."""
        self._was_stale = is_superseded and not self._yields

    @property
    def seconds(self) -> float:
        """Since the work began."""
        return self._clock() - self._begun

    def check(self) -> None:
        """Called in each Newton iteration, in the thread that computes.

        Raises
        ------
        Superseded, Cancelled, SearchLimitError
            The work ends.
        """
        self.go_on()
        if self._waits:
            self._waits = False
            self._start()
        if self._inbox.is_closed or (not self._yields and self._inbox.is_cancelled(self.seq)):
            raise Cancelled
        if self._inbox.has_waiting and self._yields:
            raise Superseded
        # longer if the search before it has ended so
        if self.seconds > (2.0 if self._was_stale else STALE_S) and self._inbox.has_waiting_edit:
            raise Superseded
        compiled = time.perf_counter() - self._clock() - self._compiled
        worked = time.thread_time() - self._worked - compiled
        # largest ratio of wall time to processor time: other programs may use the cores as well
        if worked > self.longest_s or self._clock() - self._searching_from > 3.0 * self.longest_s:
            raise SearchLimitError(f"no equilibrium within {self.longest_s:g} s; the shape is that before the edit")
        if time.monotonic() - self.last_sign > SIGN_EVERY_S:
            self._send(Busy(self.seq, f"searching for the equilibrium, {self.seconds:.0f} s"))
            self.last_sign = time.monotonic()
