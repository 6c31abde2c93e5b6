"""Ctrl-C that always arrives.

While a library is loaded, it may swallow KeyboardInterrupt or replace it by another error. The handler here also
remembers the signal, and `check` raises it again.
"""

from __future__ import annotations

import signal
from types import FrameType

_arrived = False
_written = False


def listen() -> None:
    """Let SIGINT (Ctrl-C) and SIGTERM raise KeyboardInterrupt, and remember them."""
    global _arrived, _written
    _arrived = _written = False
    for number in (signal.SIGINT, signal.SIGTERM):
        # a shell may start a background program with these signals ignored
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _note)


def over() -> None:
    """Ignore further signals while the program ends: a second Ctrl-C would cause a traceback."""
    if signal.getsignal(signal.SIGINT) is _note:
        signal.signal(signal.SIGINT, _nothing)
    if signal.getsignal(signal.SIGTERM) is _note:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def arrived() -> bool:
    """Whether an interruption has arrived."""
    return _arrived


def written() -> None:
    """Record that the results are written: the message of a later interruption differs."""
    global _written
    _written = True


def in_words() -> str:
    """Message to the user after an interruption: whether the results are written."""
    return "interrupted; " + ("the results are written" if _written else "nothing was written")


def check() -> None:
    """Raise KeyboardInterrupt if an interruption has arrived; long loops call this regularly."""
    if _arrived:
        raise KeyboardInterrupt


def _nothing(number: int, frame: FrameType | None) -> None:
    """Ignore a signal. In contrast to `SIG_IGN`, child processes do not inherit this."""


def _note(number: int, frame: FrameType | None) -> None:
    global _arrived
    _arrived = True
    raise KeyboardInterrupt
