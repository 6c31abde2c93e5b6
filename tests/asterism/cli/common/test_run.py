"""The skeleton of a command: signs of life from its first second to its last, and none while it asks."""

from __future__ import annotations

import io
import time
from collections.abc import Callable

import pytest

from asterism.cli.common import consent, progress
from asterism.cli.common.run import Run, command
from asterism.exact.cost import Cost

SIGN = "still computing"


@pytest.fixture(autouse=True)
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "MAX_QUIET_S", 0.02)


def until(holds: Callable[[], bool]) -> None:
    begun = time.perf_counter()
    while not holds():
        assert time.perf_counter() - begun < 60.0
        time.sleep(0.005)


def test_a_command_is_not_silent_while_it_loads_and_writes(capsys: pytest.CaptureFixture[str]) -> None:
    """Signs come outside the block of the computation too."""
    stream = io.StringIO()
    counts = []

    @command
    def loading(run: Run) -> None:
        run.stream = run.progress._stream = stream
        until(lambda: SIGN in stream.getvalue())
        with run.computing():
            run.say("computing")
        counts.append(stream.getvalue().count(SIGN))
        until(lambda: stream.getvalue().count(SIGN) > counts[0])

    assert loading(strict=False, yes=False, quiet=False) == 0
    count = stream.getvalue().count(SIGN)
    time.sleep(0.1)
    assert stream.getvalue().count(SIGN) == count


def test_a_computation_with_a_progress_of_its_own_is_alone() -> None:
    run = Run(quiet=True)
    with run.progress:
        stream = run.hand_over()
        assert isinstance(stream, io.StringIO)
        time.sleep(0.1)
    assert stream.getvalue() == ""


def test_nothing_is_printed_while_the_user_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Run(quiet=True)
    asked: list[str] = []

    def answer(cost: Cost) -> None:
        before = run.progress._stream.getvalue()  # type: ignore[attr-defined]
        time.sleep(0.1)
        asked.append(run.progress._stream.getvalue()[len(before) :])  # type: ignore[attr-defined]

    monkeypatch.setattr(consent, "ask", answer)
    with run.progress:
        run.cost(Cost(400_000, 8000.0, 1200.0))
    assert asked == [""]
