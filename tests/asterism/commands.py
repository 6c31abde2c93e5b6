"""Run a command, most in this process: what it prints, and how it exits."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from asterism.cli.main import main

# begins lines of a command that takes long, as any command does on a busy machine
SIGN_OF_LIFE = "  still computing, "


@dataclass(frozen=True)
class Outcome:
    """Exit status and what was printed."""

    status: int
    out: str
    err: str

    @property
    def done(self) -> Outcome:
        """The outcome of a command that has not failed."""
        assert self.status == 0, self.err
        return self

    @property
    def refusal(self) -> str:
        """The one line of a command with a mistake."""
        assert self.status == 2, self.out
        return self.line

    @property
    def line(self) -> str:
        """The one line of a command without a result."""
        lines = self.err.strip().splitlines()
        assert len(lines) == 1 and lines[0].startswith("asterism: "), self.err
        return lines[0]


# runs `asterism WORDS`, see the fixture `cli`
Cli = Callable[[list[str]], Outcome]


@contextmanager
def handlers_kept() -> Iterator[None]:
    """Whatever the block makes of Ctrl-C and a request to end, afterwards they do what they did."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def command(words: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Outcome:
    """Run `asterism WORDS`."""
    monkeypatch.setattr(sys, "argv", ["asterism", *words])
    with handlers_kept(), pytest.raises(SystemExit) as stop:
        main()
    printed = capsys.readouterr()
    errors = "".join(line for line in printed.err.splitlines(keepends=True) if not line.startswith(SIGN_OF_LIFE))
    return Outcome(int(stop.value.code or 0), printed.out, errors)


def interrupted(
    words: list[str], folder: Path, has_begun: Callable[[str], bool], number: int = signal.SIGINT
) -> list[str]:
    """Lines of errors of `asterism WORDS` in a process of its own, which gets a signal once it has begun."""
    errors = folder / "errors"
    with errors.open("w") as stream:
        process = subprocess.Popen([sys.executable, "-m", "asterism", *words], cwd=folder, stderr=stream)
    while not has_begun(errors.read_text()):
        time.sleep(0.02)
        assert process.poll() is None
    process.send_signal(number)
    assert process.wait(timeout=600) == 130
    return errors.read_text().splitlines()
