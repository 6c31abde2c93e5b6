"""Many independent cells: one file per sample, on the processes of this machine or on a Dask cluster.

A sample's file is named by a hash of all its inputs and of the code that solves it, so a campaign that is started again
takes what is there, and files of another material or version are never mistaken for its own.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from homogenize.campaign.code_version import code_version
from homogenize.campaign.workers import dask_workers, local_workers
from homogenize.law.material import Material
from homogenize.law.plan import CellTask
from pattern.design.design import Design
from pattern.design.errors import DesignError, MeshError
from pattern.design.files import plain, read_table, write_table

# raised when a sample's file means something else than before
SAMPLE_FORMAT = 1

SolveCell = Callable[[Design, float], Any]


@dataclass(frozen=True)
class SampleRecord:
    """What is known of one cell.

    Attributes
    ----------
    sample : the responses as plain data; None if there are none.
    failed : why there are none, one line.
    crashed : the reason is an exception that nobody foresaw; such a cell is tried again by the next run.
    seconds : the cell took.
    """

    task: CellTask
    sample: dict[str, Any] | None
    failed: str | None
    crashed: bool
    seconds: float


@dataclass(frozen=True)
class CampaignProgress:
    """How far a campaign is: cells done, of how many, those that failed, seconds left (None: not known yet)."""

    done: int
    total: int
    failed: int
    seconds_left: float | None
    last: SampleRecord | None


def run_campaign(
    material: Material,
    folder: Path,
    jobs: int = 1,
    dask: str | None = None,
    report: Callable[[CampaignProgress], None] | None = None,
    respond: SolveCell | None = None,
) -> list[SampleRecord]:
    """Solve every cell of the plan that has no file in `folder` yet.

    Parameters
    ----------
    folder : of the samples; made if it is missing. Files appear complete or not at all, as cells finish.
    jobs : processes on this machine; the answers do not depend on how many.
    dask : address of a Dask scheduler to use in their place.
    report : called once at the beginning and after every cell.
    respond : what solves a cell; a function that other processes can import, and whose samples are its own.

    Returns
    -------
    One record per task, in the order of `material.tasks()`.

    Raises
    ------
    CampaignError
        The workers are gone; what was finished is in `folder`.
    ValueError
        Fewer than one job.
    """
    if jobs < 1:
        raise ValueError(f"jobs = {jobs}: must be at least 1")
    solve = respond or _respond
    folder.mkdir(parents=True, exist_ok=True)
    tasks, edge = material.tasks(), material.plan.edge_mm
    records = {task: found for task in tasks if (found := _read(material, task, folder, respond)) is not None}
    missing = [task for task in tasks if task not in records]
    tell = report or (lambda progress: None)
    begin = _progress(records, tasks, None, None)
    start, before = time.perf_counter(), len(records)
    if not missing:
        tell(begin)
    else:
        workers: AbstractContextManager[Any] = (
            local_workers(min(jobs, len(missing))) if dask is None else dask_workers(dask)
        )
        missing = _longest_first(missing)
        with workers as submit_all:
            tell(begin)
            for number, outcome in submit_all(
                _one, [(solve, material.design(task), edge, code_version()) for task in missing]
            ):
                task = missing[number]
                records[task] = SampleRecord(task, *outcome)
                if not records[task].crashed:
                    records[task] = _write(material, records[task], folder, respond)
                pace = (time.perf_counter() - start) / (len(records) - before)
                tell(_progress(records, tasks, pace * (len(tasks) - len(records)), records[task]))
    return [records[task] for task in tasks]


def sample_name(material: Material, task: CellTask, respond: SolveCell | None = None) -> str:
    """Name of a sample's file: a hash of what goes into it, and of the name of what solves it in place of `sample`."""
    made = {"format": SAMPLE_FORMAT, "code": code_version()}
    text = json.dumps({**made, **_inputs(material, task, respond)}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _inputs(material: Material, task: CellTask, respond: SolveCell | None) -> dict[str, Any]:
    design = material.design(task).to_dict()
    parts = {name: design[name] for name in ("fabric", "plastic", "lattice", "stars")}
    other = {} if respond is None else {"respond": f"{respond.__module__}.{respond.__qualname__}"}
    return {**parts, "edge_mm": material.plan.edge_mm, **other}


def _respond(design: Design, edge_mm: float) -> Any:
    from homogenize.cell.sample import solve_cell

    return solve_cell(design, edge_mm)


def _one(
    respond: SolveCell, design: Design, edge_mm: float, code: str
) -> tuple[dict[str, Any] | None, str | None, bool, float]:
    """Solve one cell, in a worker: the fields of its record after the task."""
    start, crashed = time.perf_counter(), False
    try:
        if code != code_version():
            raise RuntimeError("the worker has another version of asterism")
        answer = respond(design, edge_mm)
        sample, failed = answer.to_dict(), answer.failed
    except (DesignError, MeshError) as error:  # stars that cannot be printed, or have no mesh
        sample, failed = None, str(error)
    except Exception as error:  # one bad cell must not end a campaign of hundreds
        sample, crashed, failed = None, True, f"{type(error).__name__}: {error}"
    reason = None if failed is None else " ".join(str(failed).split())
    return sample if reason is None else None, reason, crashed, time.perf_counter() - start


def _longest_first(tasks: Sequence[CellTask]) -> list[CellTask]:
    """Long arms take longest: begun first, they do not keep one worker busy at the end."""
    return sorted(tasks, key=lambda task: (-task.length_mm, task))


def _progress(
    records: dict[CellTask, SampleRecord], tasks: list[CellTask], left: float | None, last: SampleRecord | None
) -> CampaignProgress:
    failed = sum(record.failed is not None for record in records.values())
    return CampaignProgress(len(records), len(tasks), failed, left, last)


def _write(material: Material, record: SampleRecord, folder: Path, respond: SolveCell | None) -> SampleRecord:
    """Write a record, and return it as it will be read again."""
    sample = json.loads(json.dumps(plain(record.sample)))
    content = {
        "format": SAMPLE_FORMAT,
        "code": code_version(),
        "inputs": _inputs(material, record.task, respond),
        "sample": sample,
        "check": _check(sample),
        "failed": record.failed,
        "seconds": record.seconds,
    }
    # another run of the same law may have found the folder empty when it ended, and taken it away
    folder.mkdir(parents=True, exist_ok=True)
    write_table(content, folder / f"{sample_name(material, record.task, respond)}.json")
    return replace(record, sample=sample)


def _read(material: Material, task: CellTask, folder: Path, respond: SolveCell | None) -> SampleRecord | None:
    """The record of a finished sample; None if there is no whole one."""
    path = folder / f"{sample_name(material, task, respond)}.json"
    if not path.is_file():
        return None
    try:
        content = read_table(path)
        inputs = json.loads(json.dumps(_inputs(material, task, respond)))
        if content["inputs"] != inputs or content["check"] != _check(content["sample"]):
            return None
        return SampleRecord(task, content["sample"], content["failed"], False, float(content["seconds"]))
    except (DesignError, KeyError, TypeError, ValueError):
        return None


def _check(sample: Any) -> str:
    """Of a sample as it is written, whose file may be damaged and be JSON still."""
    return hashlib.sha256(json.dumps(sample, sort_keys=True).encode()).hexdigest()[:16]
