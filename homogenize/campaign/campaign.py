"""A campaign: many independent unit cells, solved on the processes of this machine or on a Dask cluster.

Each sample has a file of its own, see `homogenize.campaign.kept_samples`. So a campaign continues where it stopped, and
never uses samples of another material or of other code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from asterism.homogenize.campaign.code_version import code_version
from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome, attempt
from asterism.homogenize.campaign.workers import solve_missing
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.law.axes import sizes_text
from asterism.homogenize.law.material import Material
from asterism.homogenize.law.plan import CellTask
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, MeshError

SolveCell = Callable[[Design, float], Any]


@dataclass(frozen=True)
class SampleRecord:
    """The result of one unit cell.

    Attributes
    ----------
    task : the cell.
    sample : the responses as plain data; None for a cell without an answer.
    failed : why the cell has no answer, in one line.
    crashed : the reason is an unforeseen exception. The next run tries such a cell again.
    seconds : wall time of the cell.
    """

    task: CellTask
    sample: dict[str, Any] | None
    failed: str | None
    crashed: bool
    seconds: float

    @property
    def label(self) -> str:
        """The cell, for messages."""
        return f"stretch {self.task.stretch:g}, {sizes_text(self.task.sizes)}"


class FinishedCell(Protocol):
    """A record of any campaign: `label` names the cell, `failed` is the reason if it has no answer."""

    @property
    def label(self) -> str: ...

    @property
    def failed(self) -> str | None: ...


@dataclass(frozen=True)
class CampaignProgress:
    """State of a running campaign.

    Attributes
    ----------
    done, total, failed : numbers of cells.
    seconds_left : estimate; None before the first cell is solved.
    last : the last record; None at the beginning.
    """

    done: int
    total: int
    failed: int
    seconds_left: float | None
    last: FinishedCell | None


def run_campaign(
    material: Material,
    folder: Path,
    jobs: int = 1,
    dask: str | None = None,
    report: Callable[[CampaignProgress], None] | None = None,
    respond: SolveCell = solve_cell,
) -> list[SampleRecord]:
    """Solve every cell of the plan that has no file in `folder` yet.

    Parameters
    ----------
    folder : of the samples; the campaign makes it. Files appear whole, as cells finish.
    jobs : number of processes on this machine. The answers do not depend on it.
    dask : address of a Dask scheduler, whose workers take the place of these processes.
    report : called at the beginning and after every cell.
    respond : solves a cell. Other processes must be able to import it. Each function has samples of its own.

    Returns
    -------
    One record for each task, in the order of `material.tasks()`.

    Raises
    ------
    CampaignError
        The workers have ended. Finished samples are in `folder`.
    AddressError
        The scheduler does not answer.
    ValueError
        `jobs` is below 1.
    """
    if jobs < 1:
        raise ValueError(f"jobs = {jobs}: must be at least 1")
    folder.mkdir(parents=True, exist_ok=True)
    tasks, edge, kept = material.tasks(), material.plan.edge_mm, KeptSamples(folder, code_version())
    known = {task: kept.read(_inputs(material, task, respond)) for task in tasks}
    records = {task: _record(task, outcome) for task, outcome in known.items() if outcome is not None}
    missing = _longest_first([task for task in tasks if task not in records])
    send_report = report or (lambda progress: None)
    begin = _progress(records, tasks, None, None)
    cells = [
        (_inputs(material, task, respond), (respond, material.design(task), edge, code_version())) for task in missing
    ]
    with closing(solve_missing(kept, _solve_one, cells, jobs, dask, lambda: send_report(begin))) as solved:
        for number, outcome, left in solved:
            task = missing[number]
            records[task] = _record(task, outcome)
            send_report(_progress(records, tasks, left, records[task]))
    return [records[task] for task in tasks]


def _record(task: CellTask, outcome: Outcome) -> SampleRecord:
    return SampleRecord(task, outcome.sample, outcome.failed, outcome.crashed, outcome.seconds)


def _inputs(material: Material, task: CellTask, respond: SolveCell) -> dict[str, Any]:
    design = material.design(task).to_dict()
    parts = {name: design[name] for name in ("fabric", "plastic", "lattice", "stars")}
    other = {} if respond is solve_cell else {"respond": f"{respond.__module__}.{respond.__qualname__}"}
    graded = {"graded": True} if material.plan.graded else {}
    return {**parts, "edge_mm": material.plan.edge_mm, **graded, **other}


def _solve_one(respond: SolveCell, design: Design, edge_mm: float, code: str) -> Outcome:
    """Solve one cell in a worker."""

    def solve() -> tuple[dict[str, Any] | None, str | None]:
        if code != code_version():
            raise RuntimeError("the worker has another version of asterism")
        answer = respond(design, edge_mm)
        return answer.to_dict(), answer.failed

    # stars that cannot be printed or meshed
    return attempt(solve, DesignError, MeshError)


def _longest_first(tasks: Sequence[CellTask]) -> list[CellTask]:
    """Long arms take longest. If they begin first, all workers end at about the same time."""
    return sorted(tasks, key=lambda task: (-task.length_mm, task))


def _progress(
    records: dict[CellTask, SampleRecord], tasks: list[CellTask], left: float | None, last: SampleRecord | None
) -> CampaignProgress:
    failed = sum(record.failed is not None for record in records.values())
    return CampaignProgress(len(records), len(tasks), failed, left, last)
