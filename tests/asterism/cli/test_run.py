"""The skeleton of a command: signs of life from its first second to its last, progress, names of files."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from asterism.cli.command import Progress, Run, command, with_design_file
from asterism.equilibrium.errors import Error
from asterism.equilibrium.newton.minimise import Iteration
from asterism.exact.cost import Cost
from asterism.homogenize.errors import ForeignLaw, LawError
from asterism.homogenize.law.law_file import PAPER_LAW
from asterism.pattern.design.errors import DesignError
from asterism.process import progress
from asterism.results.words import doubts
from tests.asterism.commands import Cli

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
        before = stream.getvalue()
        time.sleep(0.1)
    assert stream.getvalue() == before


def test_nothing_is_printed_while_the_user_is_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Run(quiet=True)
    asked: list[str] = []

    def answer(cost: Cost) -> None:
        before = run.progress._stream.getvalue()  # type: ignore[attr-defined]
        time.sleep(0.1)
        asked.append(run.progress._stream.getvalue()[len(before) :])  # type: ignore[attr-defined]

    monkeypatch.setattr("asterism.cli.command._ask", answer)
    with run.progress:
        run.cost(Cost(400_000, 8000.0, 1200.0))
    assert asked == [""]


FILE = Path("leaf.toml")


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (DesignError("border.holes", "must be empty"), "leaf.toml: border.holes: must be empty"),
        (DesignError("--output", "holds other results"), "--output: holds other results"),
        (LawError("fabric.bending: has no law", field="fabric.bending"), "leaf.toml: fabric.bending: has no law"),
        (ForeignLaw("net.npz: is of stars", field="rods.motif"), "net.npz: is of stars"),
        (Error("no cluster answers"), "no cluster answers"),
    ],
)
def test_the_file_stands_before_fields_of_the_design(error: Error, message: str) -> None:
    named = with_design_file(error, FILE)
    assert str(named) == message and type(named) is type(error)


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


# an arm thicker than those of all cells of the included law
OUTSIDE = "[stars]\nlength_mm = 10.0\nthickness_mm = 2.0\n[border]\nrings = 0\n[mesh]\nedge_mm = 4.0\n"


def test_shapes_of_a_verification_are_doubted_once() -> None:
    shape = {"stars": 1, "stars_outside_law": ["star 0 is too long"], "self_intersections": 2}
    both = {"model": "verification", "preview": shape, "exact": {"stars_total": 1, "self_intersections": 2}}
    assert doubts(both) == ["the star is outside the law", "the sheet passes through itself (2 crossings)"]
    assert doubts({"stars": 2, "stars_outside_law": ["star 0"], "self_intersections": 0}) == []


@pytest.mark.slow
@pytest.mark.usefixtures("blank_pictures")
def test_strict_ends_with_1_where_the_first_line_has_a_doubt(tmp_path: Path, cli: Cli) -> None:
    (tmp_path / "d.toml").write_text(OUTSIDE)
    words = ["preview", str(tmp_path / "d.toml"), "--law", str(PAPER_LAW)]
    for options, status in ([], 0), (["--strict"], 1):
        done = cli([*words, *options])
        assert done.status == status, done.err
        assert done.out.splitlines()[0].split() == ["not", "reliable", "the", "star", "is", "outside", "the", "law"]
    assert (tmp_path / "d" / "summary.json").is_file()
