"""Ctrl-C that is not lost: a library that is just being loaded may swallow it, or make another error of it."""

from __future__ import annotations

import signal
from types import FrameType

_arrived = False
_written = False


def listen() -> None:
    """From now on Ctrl-C, and a polite request to end, raise KeyboardInterrupt and are remembered."""
    global _arrived, _written
    _arrived = _written = False
    for number in (signal.SIGINT, signal.SIGTERM):
        # who starts a program in the background may have told it to ignore them
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _note)


def over() -> None:
    """From now on Ctrl-C is ignored: what is left is to end, and a second one must not end that with a traceback."""
    if signal.getsignal(signal.SIGINT) is _note:
        signal.signal(signal.SIGINT, _nothing)
    if signal.getsignal(signal.SIGTERM) is _note:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def arrived() -> bool:
    """Whether there was one."""
    return _arrived


def written() -> None:
    """Results are where they belong: who is interrupted from now on should know."""
    global _written
    _written = True


def in_words() -> str:
    """What an interruption has left behind."""
    return "interrupted; " + ("the results are written" if _written else "nothing was written")


def check() -> None:
    """Raise KeyboardInterrupt if there was one; to be called now and then."""
    if _arrived:
        raise KeyboardInterrupt


def _nothing(number: int, frame: FrameType | None) -> None:
    """Unlike `SIG_IGN`, not handed on to programs that are started."""


def _note(number: int, frame: FrameType | None) -> None:
    global _arrived
    _arrived = True
    raise KeyboardInterrupt
