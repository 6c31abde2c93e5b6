"""Progress of a long computation: functions that follow it, one line that changes on a terminal, lines elsewhere."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Self, TextIO

from asterism.equilibrium.errors import one_line

if TYPE_CHECKING:
    from asterism.homogenize.campaign.workers import CampaignProgress

# called with each line about the progress
Say = Callable[[str], None]


def ignore_line(text: str) -> None:
    """Do nothing with a line: the listener where none is given."""


# longest silence: then a line says that the computation goes on
MAX_QUIET_S = 4.0


class ProgressLine:
    """Lines, of which a terminal shows the last one in one place; as a context it breaks long silences.

    Attributes
    ----------
    is_live : the stream is a terminal.
    start_s, written_s : time of `time.monotonic` at the start, and when something was written last.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stderr
        self.is_live = self._stream.isatty()
        self.start_s = self.written_s = time.monotonic()
        self._open = ""  # what `close` has to write
        self._lock = threading.RLock()
        self._is_over = threading.Event()

    def __enter__(self) -> Self:
        threading.Thread(target=self._watch, daemon=True).start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.end()

    def end(self) -> None:
        """Say no more that the computation goes on."""
        self._is_over.set()
        self.close()

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Print nothing within the block, in which the user is asked something."""
        with self._lock:
            self.close()
            yield
            self.written_s = time.monotonic()

    def say(self, text: str) -> None:
        """Print a line."""
        with self._lock:
            self.close()
            self._write(one_line(text) + "\n")

    def change(self, text: str) -> None:
        """Show a line in place of the last one; elsewhere than on a terminal, keep it for `close`."""
        with self._lock:
            if self.is_live:
                self._write("\r\x1b[K" + text)
            self._open = "\n" if self.is_live else f"{text}\n"

    def close(self) -> None:
        """Move the terminal to a new line."""
        with self._lock:
            if self._open:
                self._write(self._open)
                self._open = ""

    def _watch(self) -> None:
        """Break long silences, in a thread of its own: a factorisation or a picture may take longer."""
        while not self._is_over.wait(MAX_QUIET_S / 8):
            with self._lock:
                if time.monotonic() - self.written_s >= MAX_QUIET_S and not self._is_over.is_set():
                    self.say(f"  still computing, {time.monotonic() - self.start_s:.0f} s")

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()
        self.written_s = time.monotonic()


class CountLine(ProgressLine):
    """How many of similar computations are done, and why some have no answer.

    Other streams than terminals get a line every `MAX_QUIET_S`. The first failure of each reason has a line.
    """

    def __init__(self, noun: str, stream: TextIO | None = None) -> None:
        super().__init__(stream)
        self._noun = noun
        self._next_s = 0.0
        self._reasons: set[str] = set()

    def report(self, progress: CampaignProgress) -> None:
        """Show the progress, at the beginning and after each computation."""
        last, done, total = progress.last, progress.done, progress.total
        # the others that fail for a reason differ from the first one by their numbers
        if last is not None and last.failed is not None and (why := without_numbers(last.failed)) not in self._reasons:
            self._reasons.add(why)
            self.say(f"  no answer: {last.label}: {last.failed}")
        text = f"  {done} of {total} {self._noun}"
        if progress.failed:
            text += f", {progress.failed} without an answer"
        if progress.seconds_left is not None and done < total:
            minutes, seconds = divmod(round(progress.seconds_left), 60)
            text += f", about {minutes} min {seconds:02d} s left"
        if self.is_live:
            self.change(text)
        elif time.monotonic() >= self._next_s or done == total:
            self._next_s = time.monotonic() + MAX_QUIET_S
            self.say(text)


def without_numbers(problem: str) -> str:
    """The reason of a failure without its numbers, which differ from one computation to the next.

    >>> without_numbers("gradient 3.2e-05 N: no minimum")
    'gradient N: no minimum'
    """
    words = [w for w in problem.split() if not any(c.isdigit() for c in w)]
    return " ".join(words).rstrip(":,")
