"""Run a command in this process: what it prints, and how it exits."""

from __future__ import annotations

import signal
import sys
from dataclasses import dataclass

import pytest

from asterism.cli import main


@dataclass(frozen=True)
class Outcome:
    """Exit status and what was printed."""

    status: int
    out: str
    err: str

    @property
    def line(self) -> str:
        """The one line of a refused command."""
        lines = self.err.strip().splitlines()
        assert len(lines) == 1 and lines[0].startswith("asterism: "), self.err
        return lines[0]


def command(words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Outcome:
    """Run `asterism WORDS`."""
    monkeypatch.setattr(sys, "argv", ["asterism", *words])
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        with pytest.raises(SystemExit) as stop:
            main()
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    printed = capsys.readouterr()
    return Outcome(int(stop.value.code or 0), printed.out, printed.err)
