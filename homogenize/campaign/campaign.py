"""A campaign: many independent unit cells, solved on the processes of this machine or on a Dask cluster.

Each sample has a file of its own, see `homogenize.campaign.kept_samples`. So a campaign continues where it stopped, and
never uses samples of another material or of other code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome, attempt, code_version
from asterism.homogenize.campaign.workers import CampaignProgress, workers_for
from asterism.homogenize.cell.motif_responses import motif_responses
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.law.plan import CellTask, LawPlan, SampleRecord
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, MeshError


class CellAnswer(Protocol):
    """What the solution of a cell gives; a cell without an answer raises ArithmeticError."""

    def to_dict(self) -> dict[str, Any]: ...


SolveCell = Callable[[Design, float], CellAnswer]


def run_campaign(
    plan: LawPlan,
    folder: Path,
    jobs: int = 1,
    dask: str | None = None,
    report: Callable[[CampaignProgress], None] | None = None,
    respond: SolveCell | None = None,
    tasks: Sequence[CellTask] | None = None,
) -> list[SampleRecord]:
    """Solve every cell of the plan that has no file in `folder` yet.

    Raises `CampaignError` if the workers have ended. Finished samples are in `folder`. Raises `AddressError` if the
    scheduler does not answer. Raises `ValueError` if `jobs` is below 1.

    Parameters
    ----------
    folder : of the samples; the campaign makes it. Files appear whole, as cells finish.
    jobs : number of processes on this machine. The answers do not depend on it.
    dask : address of a Dask scheduler, whose workers take the place of these processes.
    report : called at the beginning and after every cell.
    respond : solves a cell, in place of `solve_cell` or `motif_responses`. Other processes must be able to import it.
        Each function has samples of its own.
    tasks : those of the plan's cells that are needed; all by default.
    """
    if jobs < 1:
        raise ValueError(f"jobs = {jobs}: must be at least 1")
    folder.mkdir(parents=True, exist_ok=True)
    solve = respond or (motif_responses if plan.is_motif else solve_cell)
    kept = KeptSamples(folder, code_version())
    tasks = plan.tasks() if tasks is None else tasks
    designs = {task: plan.cell_design(task) for task in tasks}
    inputs = {task: cell_inputs(design, plan.edge_mm, respond) for task, design in designs.items()}
    name = {task: kept.name(each) for task, each in inputs.items()}
    # a cell is solved once, also if it is both a node and a test
    once = {name[task]: task for task in reversed(tasks)}.values()
    # large cells take longest: if they begin first, all workers end at about the same time
    cells = sorted(once, key=lambda task: task.sizes, reverse=True)

    def record(task: CellTask, outcome: Outcome) -> SampleRecord:
        failed = outcome.failed or next(iter((outcome.sample or {}).get("doubts", ())), None)
        return SampleRecord(task, plan.label(task), outcome.sample, failed, outcome.seconds)

    outcomes = kept.outcomes(
        [inputs[task] for task in cells],
        lambda count: workers_for(count, jobs, dask, few=3),
        _solve_one,
        [(solve, designs[task], plan.edge_mm, code_version()) for task in cells],
        lambda number, outcome: record(cells[number], outcome),
        report,
    )
    known = dict(zip((name[task] for task in cells), outcomes, strict=True))
    return [record(task, known[name[task]]) for task in tasks]


def cell_inputs(design: Design, edge_mm: float, respond: SolveCell | None = None) -> dict[str, Any]:
    """All that the answer of a cell depends on, beside the code."""
    data = design.to_dict()
    parts = {name: data.get(name) for name in ("fabric", "plastic", "lattice", "stars", "rods")}
    other = {} if respond is None else {"respond": f"{respond.__module__}.{respond.__qualname__}"}
    return {**parts, "edge_mm": edge_mm, "graded": design.mesh.graded, **other}


def _solve_one(respond: SolveCell, design: Design, edge_mm: float, code: str) -> Outcome:
    """Solve one cell in a worker."""

    def solve() -> dict[str, Any]:
        if code != code_version():
            raise RuntimeError("the worker has another version of asterism")
        return respond(design, edge_mm).to_dict()

    # patterns that cannot be printed, meshed or relaxed
    return attempt(solve, DesignError, MeshError, ArithmeticError, np.linalg.LinAlgError)
