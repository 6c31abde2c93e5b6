"""The progress of many similar computations on a stream: how many are done, and why some have no answer."""

from __future__ import annotations

import sys
import threading
import time
from types import TracebackType
from typing import Self, TextIO

from asterism.equilibrium.errors import one_line


class CountLine:
    """How many are done.

    A terminal shows one line that changes; other streams get a line every 4 s. The first failure of each reason has a
    line. As a context it also says every 4 s that the computation goes on, if nothing else is said.
    """

    every_s = 4.0

    def __init__(self, noun: str, stream: TextIO | None = None) -> None:
        self._noun = noun
        self._stream = stream or sys.stderr
        self._live = self._stream.isatty()
        self._open = False
        self._next = 0.0
        self._reasons: set[str] = set()
        self._start = self._written = time.monotonic()
        self._lock = threading.RLock()
        self._is_over = threading.Event()

    def __enter__(self) -> Self:
        threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._is_over.set()
        self.close()

    def _watch(self) -> None:
        while not self._is_over.wait(self.every_s / 8):
            with self._lock:
                if time.monotonic() - self._written >= self.every_s and not self._is_over.is_set():
                    self._line(f"  still computing, {time.monotonic() - self._start:.0f} s")

    def show(self, done: int, total: int, failed: int, seconds_left: float | None) -> None:
        """Show the progress."""
        text = f"  {done} of {total} {self._noun}"
        if failed:
            text += f", {failed} without an answer"
        if seconds_left is not None and done < total:
            minutes, seconds = divmod(round(seconds_left), 60)
            text += f", about {minutes} min {seconds:02d} s left"
        if self._live:
            with self._lock:
                self._write("\r\x1b[K" + text)
                self._open = True
        elif time.monotonic() >= self._next or done == total:
            self._next = time.monotonic() + self.every_s
            self._line(text)

    def failed(self, which: str, problem: str) -> None:
        """Name the first one that fails for a reason: the others differ from it by their numbers."""
        if (reason := without_numbers(problem)) not in self._reasons:
            self._reasons.add(reason)
            self._line(one_line(f"  no answer: {which}: {problem}"))

    def close(self) -> None:
        """Move the terminal to a new line."""
        with self._lock:
            if self._open:
                self._write("\n")
                self._open = False

    def _line(self, text: str) -> None:
        with self._lock:
            self._write(("\r\x1b[K" if self._open else "") + text + "\n")
            self._open = False

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()
        self._written = time.monotonic()


def without_numbers(problem: str) -> str:
    """The reason of a failure without its numbers, which differ from one computation to the next.

    >>> without_numbers("gradient 3.2e-05 N: no minimum")
    'gradient N: no minimum'
    """
    words = [w for w in problem.split() if not any(c.isdigit() for c in w)]
    return " ".join(words).rstrip(":,")
