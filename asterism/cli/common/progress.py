"""Progress on standard error during a command."""

from __future__ import annotations

import shutil
import time
from typing import TYPE_CHECKING

from asterism.process.progress_line import ProgressLine

if TYPE_CHECKING:
    # it loads numpy and scipy, which takes part of the time that this module shows
    from asterism.equilibrium.newton.minimise import Iteration


class Progress(ProgressLine):
    """One changing line on a terminal; elsewhere one line for each stage."""

    _stage = ""

    def report(self, stage: str, iteration: Iteration) -> None:
        """Show an iteration; `stage` describes the stage, such as the released part of the stretch."""
        if stage != self._stage and not self.is_live:
            self.close()
        self._stage = stage
        name = f"{stage} released" if stage.endswith("%") else stage
        begin = f"  {name:<32} iteration {iteration.number:<4} energy {iteration.energy:.4f} N mm"
        clock = f"   {time.monotonic() - self.start_s:.1f} s"
        line = f"{begin}   gradient {iteration.gradient_norm:.1e} N{clock}"
        # a line that wraps cannot be replaced
        room = shutil.get_terminal_size().columns - 1
        if self.is_live and len(line) > room:
            line = (begin[: max(room - len(clock), 0)] + clock)[:room]
        self.change(line)
