"""Errors of targets and of fits."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from asterism.equilibrium.errors import Error, one_line

if TYPE_CHECKING:
    from asterism.equilibrium.arrays import Floats


class TargetError(Error, ValueError):
    """A surface cannot be a target; the message is one line that begins with the name of the target."""

    def __init__(self, target: str | Path, problem: str) -> None:
        super().__init__(one_line(f"{target}: {problem}"))


class ReachError(Error):
    """A target is out of reach of the stars; the message is one line with place, needed and available value."""

    exit_status = 1


def place_text(place: Floats, decimals: int = 1) -> str:
    """A place (3,) in mm, for messages."""
    return "(" + ", ".join(f"{coordinate:.{decimals}f}" for coordinate in place) + ") mm"
