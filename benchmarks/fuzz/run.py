"""Runs cases, each in a process of its own that is a copy of this one, and says what counts as a failure."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.errors import Error
from benchmarks.fuzz.cases import DESIGNS, Case, make_case, make_kit
from benchmarks.fuzz.nested import difference

MAX_SECONDS = 60  # processor time of a case
MAX_GROWTH = 1.25  # diameter of a sheet over that of its print, or of its supports if they pull it wider
DONE, NO_ANSWER, WRONG_INPUT = 0, 1, 2  # exit statuses of commands


@dataclass(frozen=True)
class Outcome:
    """A case and how it ended: exit status, processor time in s, and what is wrong with it."""

    case: Case
    status: int
    seconds: float
    failures: tuple[str, ...]


def run_cases(
    numbers: Iterable[int], tell: Callable[[Outcome], None] | None = None, kind: str | None = None
) -> list[Outcome]:
    """Run the cases of these numbers, one after the other, on a system that can copy a running process."""
    outcomes = []
    with tempfile.TemporaryDirectory() as room:
        kit = Path(room) / "kit"
        kit.mkdir()
        make_kit(kit)
        _warm_up(kit)
        for number in numbers:
            folder = Path(room) / "case"
            folder.mkdir()
            outcomes.append(_run(number, kit, folder, kind))
            shutil.rmtree(folder)
            if tell:
                tell(outcomes[-1])
    return outcomes


def _warm_up(kit: Path) -> None:
    """Do once what most cases do: they find modules loaded, loops compiled and fonts chosen."""
    import asterism
    import asterism.cli.main
    import asterism.measure.fit_strips
    import asterism.sweeps.sweep

    asterism.cli.main.application()
    for name in ("star", "pinned"):
        design = asterism.Design.from_dict(DESIGNS[name])
        asterism.verify(design)
        asterism.export(design, kit.parent / f"warm-{name}")
        asterism.report(design, kit.parent / f"{name}.pdf")
    asterism.compare(kit / "shape", kit / "scan.obj")


def _run(number: int, kit: Path, folder: Path, kind: str | None) -> Outcome:
    case = make_case(number, kit, folder, kind)
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
    return Outcome(case, status, usage.ru_utime + usage.ru_stime, wrong)


def _command(case: Case, folder: Path, errors: Path) -> None:
    """Run the command line of a case, and end this process."""
    import resource

    status = 99  # unforeseen
    try:
        os.chdir(folder)
        for name, descriptor in ((os.devnull, 0), (os.devnull, 1), (str(errors), 2)):
            flags = os.O_RDONLY if descriptor == 0 else os.O_WRONLY | os.O_CREAT | os.O_TRUNC
            os.dup2(os.open(name, flags), descriptor)
        sys.stdout, sys.stderr = (os.fdopen(n, "w", errors="backslashreplace", closefd=False) for n in (1, 2))
        resource.setrlimit(resource.RLIMIT_CPU, (MAX_SECONDS, MAX_SECONDS + 5))
        # in one case of ten, pictures are drawn, layouts have texts and sweeps have processes of their own; the others
        # do without, since a picture takes half a second, the fonts of a layout another, and a new process seconds
        if case.number % 10:
            _do_less()
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


def _do_less() -> None:
    """Make pictures of shapes blank, leave texts out of layouts, and let campaigns and sweeps use this process."""
    from PIL import Image

    import asterism.print.formats.pdf
    import asterism.reports.write_results
    from asterism.homogenize.campaign import workers

    blank = Image.new("RGB", (8, 8))
    asterism.reports.write_results.draw_shape = lambda shape, title, path: blank.save(path, format="png")
    asterism.print.formats.pdf._write_text = lambda figure, item, to_page: None
    workers.local_workers = lambda jobs: workers.this_process()


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


def files_in(folder: Path) -> set[str]:
    """All files and folders below a folder, by their path."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def failures(case: Case, status: int, errors: str, folder: Path, before: set[str]) -> Iterator[str]:
    """Yield what is wrong with a case that ended with a status (negative: of a signal) and these lines of errors."""
    new = files_in(folder) - before
    if "Traceback (most recent call last)" in errors:
        yield f"traceback: {errors.strip().splitlines()[-1][:200]}"
    elif status < 0:
        name = signal.Signals(-status).name
        yield f"more than {MAX_SECONDS} s of processor time" if name == "SIGXCPU" else f"ended by {name}"
    elif status not in (DONE, NO_ANSWER, WRONG_INPUT):
        yield f"exit status {status}"
    lines = errors.strip().splitlines()
    if status == WRONG_INPUT and not (lines and lines[-1].startswith("asterism: ")):
        yield f"exit status 2 without a line that names the mistake: {lines[-1:]}"
    if status == WRONG_INPUT and new:
        yield f"exit status 2, and left {sorted(new)[:3]}"
    if left := [name for name in new if ".asterism-" in name or Path(name).name.startswith(".")]:
        yield f"left {sorted(left)[:3]}"
    if status == NO_ANSWER and not any(line.startswith("asterism: ") for line in lines):
        yield "exit status 1 without a reason"
    for path in sorted(folder / name for name in new):
        if path.is_file():
            yield from _of_file(path)
    for drawing in folder.glob("nested.*"):
        if words := difference(drawing):
            yield f"{drawing.name}: {words}"


def _of_file(path: Path) -> Iterator[str]:
    """A result with a number that is none, or a shape that no fabric can take."""
    from asterism.shape.vtu import read_shape

    def not_a_number(word: str) -> Any:
        raise ValueError(word)

    try:
        if path.suffix == ".json":
            json.loads(path.read_text(), parse_constant=not_a_number)
        if path.suffix != ".vtu" or path.name == "rods.vtu":
            return
        shape = read_shape(path)  # it refuses positions that are not finite
    except (Error, ValueError) as error:
        yield f"{path.name} holds {error}"
        return
    reach = _size(shape.printed)
    if shape.plan is not None:
        for pins in shape.plan.pins:
            held = [pins.points, *(end[None] for segment in pins.segments(shape.plan.edges) for end in segment)]
            places = np.concatenate([pins.places(points) for points in held if len(points)])
            reach = max(reach, _size(places) + _size(shape.printed) * (len(places) == 1))
    if _size(shape.positions) > MAX_GROWTH * reach:
        yield f"{path.name} is {_size(shape.positions):.0f} mm large, its print {_size(shape.printed):.0f} mm"


def _size(points: np.ndarray) -> float:
    """Diagonal (mm) of the box around points."""
    return float(np.linalg.norm(np.ptp(points, axis=0)))
