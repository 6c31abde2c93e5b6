"""Progress on standard error during a command."""

from __future__ import annotations

import shutil
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Self, TextIO

from asterism.equilibrium.errors import one_line

if TYPE_CHECKING:
    # it loads numpy and scipy, which takes part of the time that this module shows
    from asterism.equilibrium.newton.minimise import Iteration

# longest silence: then a line says that the computation goes on
MAX_QUIET_S = 4.0


class Progress:
    """One changing line on a terminal; elsewhere one line for each stage.

    As a context it also says every `MAX_QUIET_S` seconds that the computation goes on, if nothing else is said.
    """

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stderr
        self._live = self._stream.isatty()
        self._start = time.perf_counter()
        self._last = ""
        self._stage = ""
        self._lock = threading.Lock()
        self._written = self._start
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
            self._finish()
            yield
            self._written = time.perf_counter()

    def _watch(self) -> None:
        """Break long silences, in a thread of its own: a factorisation or a picture may take longer."""
        while not self._is_over.wait(MAX_QUIET_S / 8):
            with self._lock:
                if time.perf_counter() - self._written >= MAX_QUIET_S and not self._is_over.is_set():
                    self._finish()
                    self._write(f"  still computing, {time.perf_counter() - self._start:.0f} s\n")

    def _write(self, text: str) -> None:
        self._stream.write(text)
        self._stream.flush()
        self._written = time.perf_counter()

    def say(self, text: str) -> None:
        """Print a line."""
        with self._lock:
            self._finish()
            self._write(one_line(text) + "\n")

    def report(self, stage: str, iteration: Iteration) -> None:
        """Show an iteration; `stage` describes the stage, such as the released part of the stretch."""
        with self._lock:
            self._show(stage, iteration)

    def _show(self, stage: str, iteration: Iteration) -> None:
        if stage != self._stage and not self._live and self._last:
            self._write(self._last + "\n")
        self._stage = stage
        name = f"{stage} released" if stage.endswith("%") else stage
        begin = f"  {name:<32} iteration {iteration.number:<4} energy {iteration.energy:.4f} N mm"
        clock = f"   {time.perf_counter() - self._start:.1f} s"
        self._last = f"{begin}   gradient {iteration.gradient_norm:.1e} N{clock}"
        if self._live:
            # a line that wraps cannot be replaced
            room = shutil.get_terminal_size().columns - 1
            shown = self._last if len(self._last) <= room else begin[: max(room - len(clock), 0)] + clock
            self._write("\r\x1b[K" + shown[:room])

    def close(self) -> None:
        """Move the terminal to a new line."""
        with self._lock:
            self._finish()

    def _finish(self) -> None:
        if self._last:
            self._write("\n" if self._live else self._last + "\n")
            self._last = ""
