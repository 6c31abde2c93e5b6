"""The functions that follow a computation."""

from __future__ import annotations

from collections.abc import Callable

# called with each line about the progress
Say = Callable[[str], None]


def ignore_line(text: str) -> None:
    """Do nothing with a line: the listener where none is given."""
