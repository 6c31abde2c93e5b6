"""Runs cases, each in a process of its own that is a copy of this one: nothing is loaded twice."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from asterism.homogenize.campaign.workers import SubmitAll
from benchmarks.fuzz.cases import Case, make_case
from benchmarks.fuzz.judge import MAX_SECONDS, failures, files_in
from benchmarks.fuzz.kit import make_kit

# in one case of this many, pictures are drawn and sweeps have processes of their own; in the others pictures are blank
# and sweeps compute in the process of the case, since a picture takes half a second and a new process seconds
COMPLETE_EVERY = 10
UNFORESEEN = 99


@dataclass(frozen=True)
class Outcome:
    """A case and how it ended: exit status, processor time in s, what is wrong with it, the last line of errors."""

    case: Case
    status: int
    seconds: float
    failures: tuple[str, ...]
    last_line: str = ""


def run_cases(numbers: Iterable[int], tell: Callable[[Outcome], None] | None = None) -> list[Outcome]:
    """Run the cases of these numbers, one after the other.

    Raises
    ------
    OSError
        The system cannot copy a running process (Windows).
    """
    outcomes = []
    with tempfile.TemporaryDirectory() as room:
        kit = Path(room) / "kit"
        kit.mkdir()
        make_kit(kit)
        _load_all()
        for number in numbers:
            folder = Path(room) / "case"
            folder.mkdir()
            outcomes.append(_run(number, kit, folder))
            shutil.rmtree(folder)
            if tell:
                tell(outcomes[-1])
    return outcomes


def _load_all() -> None:
    """Load what commands load, so that each case finds it."""
    import asterism.cli.app
    import asterism.cli.fit
    import asterism.exact.simulation
    import asterism.measure.compare.compare
    import asterism.measure.strips.fit_strips
    import asterism.print.export
    import asterism.reports.compare_designs
    import asterism.reports.design_report
    import asterism.sweeps.run
    import asterism.verification.run  # noqa: F401


def _run(number: int, kit: Path, folder: Path) -> Outcome:
    case = make_case(number, kit, folder)
    before = files_in(folder)
    errors = folder.parent / "errors.txt"
    # processes that end after their case, as Python's tracker of locks does, write into the old file
    errors.unlink(missing_ok=True)
    child = os.fork()
    if child == 0:
        _command(case, folder, errors)
    _, code, usage = os.wait4(child, 0)
    status = os.waitstatus_to_exitcode(code)
    text = errors.read_text(errors="replace")
    wrong = tuple(failures(case, status, text, folder, before))
    last_line = text.strip().rpartition("\n")[2]
    return Outcome(case, status, usage.ru_utime + usage.ru_stime, wrong, last_line)


def _command(case: Case, folder: Path, errors: Path) -> None:
    """Run the command line of a case, and end this process."""
    import resource

    status = UNFORESEEN
    try:
        os.chdir(folder)
        for name, descriptor in ((os.devnull, 0), (os.devnull, 1), (str(errors), 2)):
            flags = os.O_RDONLY if descriptor == 0 else os.O_WRONLY | os.O_CREAT | os.O_TRUNC
            os.dup2(os.open(name, flags), descriptor)
        sys.stdout, sys.stderr = (os.fdopen(n, "w", errors="backslashreplace", closefd=False) for n in (1, 2))
        resource.setrlimit(resource.RLIMIT_CPU, (MAX_SECONDS, MAX_SECONDS + 5))
        if case.number % COMPLETE_EVERY:
            _draw_nothing()
            _compute_here()
        sys.argv = ["asterism", *case.words]
        from asterism.cli.main import main

        main()
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(status)


def _draw_nothing() -> None:
    """Make pictures of shapes blank."""
    from PIL import Image

    import asterism.reports.write_results

    def blank(shape: object, title: str, path: object) -> None:
        Image.new("RGB", (8, 8)).save(path, format="png")  # type: ignore[arg-type]

    asterism.reports.write_results.draw_shape = blank


def _compute_here() -> None:
    """Let sweeps compute in this process."""
    import asterism.sweeps.run

    @contextmanager
    def no_workers(jobs: int) -> Iterator[SubmitAll]:
        yield lambda function, arguments: ((number, function(*given)) for number, given in enumerate(arguments))

    asterism.sweeps.run.local_workers = no_workers


def summary(outcomes: list[Outcome]) -> list[list[str]]:
    """Rows of a table: kind of input, cases, their exit statuses, seconds of the longest, failures."""
    rows = []
    for kind in sorted({outcome.case.kind for outcome in outcomes}):
        of_kind = [outcome for outcome in outcomes if outcome.case.kind == kind]
        statuses = Counter(outcome.status for outcome in of_kind)
        longest = max(outcome.seconds for outcome in of_kind)
        failed = sum(bool(outcome.failures) for outcome in of_kind)
        counts = [str(statuses[status]) for status in (0, 1, 2)]
        rows.append([kind, str(len(of_kind)), *counts, f"{longest:.1f}", str(failed)])
    return rows
