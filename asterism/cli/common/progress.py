"""Progress on standard error during a minimisation."""

from __future__ import annotations

import shutil
import sys
import time
from typing import TextIO

from asterism.process import interruption
from equilibrium.newton.minimise import Iteration


class Progress:
    """One changing line on a terminal; elsewhere one line for each stage."""

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stderr
        self._live = self._stream.isatty()
        self._start = time.perf_counter()
        self._last = ""
        self._stage = ""

    def say(self, text: str) -> None:
        """Print a line."""
        interruption.check()
        self._finish()
        self._stream.write(text + "\n")
        self._stream.flush()

    def report(self, stage: str, iteration: Iteration) -> None:
        """Show an iteration; `stage` describes the stage, such as the released part of the stretch."""
        interruption.check()
        if stage != self._stage and not self._live and self._last:
            self._stream.write(self._last + "\n")
            self._stream.flush()
        self._stage = stage
        name = f"{stage} released" if stage.endswith("%") else stage
        begin = f"  {name:<32} iteration {iteration.number:<4} energy {iteration.energy:.4f} N mm"
        clock = f"   {time.perf_counter() - self._start:.1f} s"
        self._last = f"{begin}   gradient {iteration.gradient_norm:.1e} N{clock}"
        if self._live:
            # a line that wraps cannot be replaced
            room = shutil.get_terminal_size().columns - 1
            shown = self._last if len(self._last) <= room else begin[: max(room - len(clock), 0)] + clock
            self._stream.write("\r\x1b[K" + shown[:room])
            self._stream.flush()

    def close(self) -> None:
        """Move the terminal to a new line."""
        self._finish()

    def _finish(self) -> None:
        if self._last:
            self._stream.write("\n" if self._live else self._last + "\n")
            self._last = ""
