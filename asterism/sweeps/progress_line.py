"""Progress of a sweep on a stream."""

from __future__ import annotations

from typing import TextIO

from asterism.process.count_line import CountLine
from asterism.sweeps.run import SweepProgress


class SweepProgressLine(CountLine):
    """Progress of a sweep on a stream."""

    def __init__(self, stream: TextIO | None = None) -> None:
        super().__init__("designs", stream)

    def report(self, progress: SweepProgress) -> None:
        """Show the progress, at the beginning and after each design."""
        point = progress.last
        if point is not None and point.problem is not None:
            which = ", ".join(f"{path} = {value}" for path, value in point.parameters.items())
            self.failed(f"design {point.number}, {which}", point.problem)
        self.show(progress.done, progress.total, progress.failed, progress.seconds_left)
