"""What counts as a failure of a case."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.errors import Error
from benchmarks.fuzz.cases import Case

# processor time that a case may take
MAX_SECONDS = 60
# diameter of a sheet over that of its print, or of its supports if they pull it wider
MAX_GROWTH = 1.25
# exit statuses of commands: done, no answer, wrong input
DONE, NO_ANSWER, WRONG_INPUT = 0, 1, 2
# names of files that no command may leave behind
STAGING = ".asterism-"


def files_in(folder: Path) -> set[str]:
    """All files and folders below a folder, by their path."""
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def failures(case: Case, status: int, errors: str, folder: Path, before: set[str]) -> Iterator[str]:
    """Yield what is wrong with the end of a case.

    Parameters
    ----------
    status : exit status; negative for the signal that ended the process.
    errors : what the command printed on standard error.
    before : the files before it ran.
    """
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
    if left := [name for name in new if STAGING in name or Path(name).name.startswith(".")]:
        yield f"left {sorted(left)[:3]}"
    if status == NO_ANSWER and not any(line.startswith("asterism: ") for line in lines):
        yield "exit status 1 without a reason"
    for name in sorted(new):
        yield from _of_file(folder / name)


def _of_file(path: Path) -> Iterator[str]:
    """A result with a number that is none, or a shape that no fabric can take."""
    if path.is_dir():
        return
    if path.suffix == ".json":

        def not_a_number(word: str) -> Any:
            raise ValueError(word)

        try:
            json.loads(path.read_text(), parse_constant=not_a_number)
        except ValueError as error:
            yield f"{path.name} holds {error}"
    if path.suffix == ".vtu" and path.name != "rods.vtu":
        yield from _of_shape(path)


def _of_shape(path: Path) -> Iterator[str]:
    from asterism.shape.read_shape import read_shape

    try:
        shape = read_shape(path)
    except Error as error:  # it refuses positions that are not finite
        yield f"{path.name} cannot be read again: {error}"
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
