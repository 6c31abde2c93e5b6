"""What is seen while the energy is being minimised."""

from __future__ import annotations

import io

import pytest

from asterism.cli.run import Progress
from asterism.equilibrium.newton.minimise import Iteration


class Terminal(io.StringIO):
    """A stream that says it is one."""

    def isatty(self) -> bool:
        return True


def seen(stream: io.StringIO, iterations: int = 3) -> str:
    progress = Progress(stream)
    for number in range(iterations):
        progress.report("58381 vertices, 100 %", Iteration(number, 123456.789, 1.2e-3, 0.0, 1.0))
    progress.close()
    return stream.getvalue()


@pytest.mark.parametrize(("columns", "gradient"), [(140, True), (80, False), (40, False)])
def test_the_line_on_a_terminal_never_wraps(columns: int, gradient: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the last row of a line that wraps could be written over."""
    monkeypatch.setenv("COLUMNS", str(columns))
    lines = seen(Terminal()).rstrip("\n").split("\r\x1b[K")[1:]
    assert len(lines) == 3 and all(len(line) < columns for line in lines)
    assert all(("gradient" in line) is gradient and "58381 vertices, 100 %" in line for line in lines)
    assert all(line.endswith(" s") for line in lines)


def test_elsewhere_a_stage_is_one_whole_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    text = seen(io.StringIO())
    assert text.count("\n") == 1 and "gradient 1.2e-03 N" in text and "released" in text
