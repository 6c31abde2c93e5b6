"""Ctrl-C that is not lost: a library that is just being loaded may swallow it, or make another error of it."""

from __future__ import annotations

import signal
from types import FrameType

_arrived = False


def listen() -> None:
    """From now on Ctrl-C, and a polite request to end, raise KeyboardInterrupt and are remembered."""
    global _arrived
    _arrived = False
    for number in (signal.SIGINT, signal.SIGTERM):
        # who starts a program in the background may have told it to ignore them
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _note)


def arrived() -> bool:
    """Whether there was one."""
    return _arrived


def check() -> None:
    """Raise KeyboardInterrupt if there was one; to be called now and then."""
    if _arrived:
        raise KeyboardInterrupt


def _note(number: int, frame: FrameType | None) -> None:
    global _arrived
    _arrived = True
    raise KeyboardInterrupt
