"""Finished samples of long computations, one file each, so that an interrupted computation continues where it stopped.

The name of a file is a hash of the inputs and of the code that computes the sample. So a sample never stands for other
inputs or for other code. Files appear whole and never change: a second writer writes the same file, and a process that
is killed leaves none. A user's unit cells have one folder for all projects and processes; the oldest ones go when there
are many.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType
from typing import Any

import platformdirs

from asterism import discrete, equilibrium, homogenize, pattern
from asterism.homogenize.campaign.workers import CampaignProgress, Finished, SubmitAll
from asterism.homogenize.errors import CampaignError
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.files import plain, read_table, write_table

# names another folder
FOLDER_VARIABLE = "ASTERISM_CELLS"


def cells_folder() -> Path:
    """The folder, which exists afterwards; that of the environment variable `ASTERISM_CELLS`, if it is set.

    Raises `CampaignError` if the folder cannot be made.
    """
    own = os.environ.get(FOLDER_VARIABLE)
    folder = Path(own) if own else Path(platformdirs.user_cache_dir("asterism", appauthor=False)) / "cells"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        problem = f"cannot make the folder of the cells, {folder}: {reason}; {FOLDER_VARIABLE} names another"
        raise CampaignError(problem) from None
    return folder


def forget_oldest(folder: Path, most: int = 10_000) -> int:
    """Remove the cells (of about 10 kB each) that were solved longest ago but for so many; return how many went."""
    cells = []
    with os.scandir(folder) as entries:
        for entry in entries:
            with suppress(FileNotFoundError):  # another process forgets it at this moment
                if entry.name.endswith(".json"):
                    cells.append((entry.stat().st_mtime, entry.path))
    leaving = sorted(cells)[: max(len(cells) - most, 0)]
    for _, path in leaving:
        with suppress(OSError):  # another process was faster
            os.unlink(path)
    return len(leaving)


# what of the packages shapes the answer of a cell
SAMPLE_SOURCES = {
    discrete: ("**/*.py",),
    equilibrium: ("**/*.py",),
    pattern: (
        "rods/*.py", "mesh/triangulate.py", "mesh/outline_points.py", "geometry/*.py",
        "design/lattice.py", "design/materials.py",
        "layout/layout.py",
        "mesh/graded_mesh.py", "layout/supports.py", "layout/sheet_edges.py",
        "mesh/mesh.py", "design/rounding.py",
    ),
    homogenize: ("cell/*.py", "law/anisotropy.py"),
}  # fmt: skip


@functools.cache
def code_version() -> str:
    """Hash of the sources; the same wherever the same code is installed."""
    return sources_hash(SAMPLE_SOURCES)


def sources_hash(sources: Mapping[ModuleType, Sequence[str]]) -> str:
    """Hash of the source files of packages that match one of the patterns of each."""
    known = hashlib.sha256()
    for package, names in sources.items():
        folder = Path(package.__path__[0])
        for file in sorted(path for name in names for path in folder.glob(name)):
            known.update(f"{package.__name__}/{file.relative_to(folder).as_posix()}\n".encode())
            known.update(file.read_text(encoding="utf-8").encode())  # whatever ends its lines
    return known.hexdigest()[:16]


# raise it when the content of a sample's file changes its meaning
SAMPLE_FORMAT = 1


@dataclass(frozen=True)
class Outcome:
    """The result of one computation."""

    sample: dict[str, Any] | None  # plain data; None without an answer
    failed: str | None  # why there is no answer, in one line
    # the inputs are not the reason: an unforeseen exception, or a file that this worker cannot read. Such a sample is
    # not kept, and the next run tries it again.
    crashed: bool
    seconds: float  # wall time


@dataclass(frozen=True)
class KeptSamples:
    """A folder of finished samples."""

    folder: Path  # is made when the first sample is written
    code: str  # name of the code that computes the samples

    def name(self, inputs: Mapping[str, Any]) -> str:
        """Name of a sample's file without its ending."""
        made = {"format": SAMPLE_FORMAT, "code": self.code}
        text = json.dumps({**made, **inputs}, sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:24]

    def read(self, inputs: Mapping[str, Any]) -> Outcome | None:
        """The outcome of a finished computation; None without a whole file."""
        path = self._path(inputs)
        if not path.is_file():
            return None
        try:
            content = read_table(path)
            return Outcome(content["sample"], content["failed"], False, float(content["seconds"]))
        except (DesignError, KeyError, TypeError, ValueError):
            return None

    def write(self, inputs: Mapping[str, Any], outcome: Outcome) -> Outcome:
        """Write an outcome, unless it crashed, and return what reading it gives."""
        if outcome.crashed:
            return outcome
        sample = json.loads(json.dumps(plain(outcome.sample)))
        content = {
            "format": SAMPLE_FORMAT,
            "code": self.code,
            "inputs": dict(inputs),
            "sample": sample,
            "failed": outcome.failed,
            "seconds": outcome.seconds,
        }
        # another run of the same command may have removed the folder, which was empty when that run ended
        self.folder.mkdir(parents=True, exist_ok=True)
        write_table(content, self._path(inputs))
        return replace(outcome, sample=sample)

    def outcomes(
        self,
        inputs: Sequence[Mapping[str, Any]],
        workers: Callable[[int], AbstractContextManager[SubmitAll]],
        solve: Callable[..., Outcome],
        arguments: Sequence[tuple[Any, ...]],
        finished: Callable[[int, Outcome], Finished],
        report: Callable[[CampaignProgress], None] | None,
    ) -> list[Outcome]:
        """The outcome for each of the inputs: read if it is in the folder, otherwise solved and written.

        Parameters
        ----------
        workers : those that solve so many.
        solve, arguments : the function that the workers call, and its arguments for each of the inputs.
        finished : what a report says of an outcome, by its position.
        report : called at the beginning and after every solution.
        """
        known = {number: outcome for number, each in enumerate(inputs) if (outcome := self.read(each)) is not None}
        missing = [number for number in range(len(inputs)) if number not in known]
        failed = sum(finished(*pair).failed is not None for pair in known.items())
        send_report, start = report or (lambda progress: None), time.perf_counter()
        with workers(len(missing)) as submit_all:
            send_report(CampaignProgress(len(known), len(inputs), failed, None, None))
            for count, (position, outcome) in enumerate(submit_all(solve, [arguments[n] for n in missing]), 1):
                number = missing[position]
                known[number] = self.write(inputs[number], outcome)
                last = finished(number, known[number])
                failed += last.failed is not None
                left = (time.perf_counter() - start) / count * (len(missing) - count)
                send_report(CampaignProgress(len(known), len(inputs), failed, left, last))
        return [known[number] for number in range(len(inputs))]

    def _path(self, inputs: Mapping[str, Any]) -> Path:
        return self.folder / f"{self.name(inputs)}.json"


def attempt(
    solve: Callable[[], dict[str, Any]],
    *foreseen: type[Exception],
    surroundings: tuple[type[Exception], ...] = (),
) -> Outcome:
    """Run one computation in a worker. Its errors are outcomes: one of them must not end hundreds of others.

    Parameters
    ----------
    solve : gives the sample.
    foreseen : errors that the inputs cause, so that another attempt would raise them too.
    surroundings : those among them that the worker's machine causes, such as a missing file.
    """
    start, crashed = time.perf_counter(), False
    sample: dict[str, Any] | None = None
    failed: str | None = None
    try:
        sample = solve()
    except surroundings as error:
        crashed, failed = True, str(error)
    except foreseen as error:
        failed = str(error)
    except Exception as error:
        crashed, failed = True, f"{type(error).__name__}: {error}"
    reason = None if failed is None else " ".join(failed.split())
    return Outcome(sample, reason, crashed, time.perf_counter() - start)
