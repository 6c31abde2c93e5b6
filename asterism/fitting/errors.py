"""Errors of targets."""

from __future__ import annotations

from pathlib import Path

from equilibrium.errors import Error
from pattern.design.errors import one_line


class TargetError(Error, ValueError):
    """A surface cannot be a target; the message is one line that begins with the name of the target."""

    def __init__(self, target: str | Path, problem: str) -> None:
        super().__init__(one_line(f"{target}: {problem}"))


class ReachError(Error):
    """A target is out of reach of the stars; the message is one line with place, needed and available value."""

    exit_status = 1
