"""The campaign that solves the cells of the law of a motif, with files as of `homogenize.campaign.campaign`."""

from __future__ import annotations

import functools
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism import homogenize, pattern
from asterism.homogenize.campaign.campaign import CampaignProgress
from asterism.homogenize.campaign.code_version import SAMPLE_SOURCES, sources_hash
from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome, attempt
from asterism.homogenize.campaign.motif_sample import responses_to_data
from asterism.homogenize.campaign.workers import solve_missing
from asterism.homogenize.cell.motif_responses import MotifResponses, motif_responses
from asterism.homogenize.law.motif_plan import MotifPlan, MotifTask
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError, MeshError

SolveMotif = Callable[[Design, float], MotifResponses]
# what shapes the answer of a motif's cell, beside what shapes that of a star's
MOTIF_SOURCES = SAMPLE_SOURCES | {
    pattern: (*SAMPLE_SOURCES[pattern], "rods/*.py", "mesh/free/*.py", "mesh/outline_points.py", "geometry/*.py"),
    homogenize: (*SAMPLE_SOURCES[homogenize], "campaign/motif_sample.py", "law/anisotropy.py"),
}


@dataclass(frozen=True)
class MotifRecord:
    """The result of one unit cell.

    Attributes
    ----------
    task : the cell.
    label : its sizes, for messages.
    sample : the responses as plain data; None for a cell without an answer.
    failed : why there is no law of the cell, in one line.
    crashed : the reason is an unforeseen exception. The next run tries such a cell again.
    seconds : wall time of the cell.
    """

    task: MotifTask
    label: str
    sample: dict[str, Any] | None
    failed: str | None
    crashed: bool
    seconds: float


def run_motif_campaign(
    plan: MotifPlan,
    folder: Path,
    jobs: int = 1,
    dask: str | None = None,
    report: Callable[[CampaignProgress], None] | None = None,
    respond: SolveMotif = motif_responses,
) -> list[MotifRecord]:
    """Solve every cell of the plan that has no file in `folder` yet.

    Parameters
    ----------
    folder, jobs, dask, report : as of `homogenize.campaign.campaign.run_campaign`.
    respond : solves a cell. Other processes must be able to import it. Each function has samples of its own.

    Returns
    -------
    One record for each task, in the order of `plan.tasks()`.

    Raises
    ------
    CampaignError, AddressError, ValueError
        As of `run_campaign`.
    """
    if jobs < 1:
        raise ValueError(f"jobs = {jobs}: must be at least 1")
    tasks, kept = plan.tasks(), KeptSamples(folder, motif_code_version())
    # a cell is solved once, also if it is both a node and a test
    inputs = {task.sizes: _inputs(plan, task, respond) for task in tasks}
    outcomes = {sizes: kept.read(each) for sizes, each in inputs.items()}
    known = {sizes: outcome for sizes, outcome in outcomes.items() if outcome is not None}
    missing = [sizes for sizes in inputs if sizes not in known]
    send_report = report or (lambda progress: None)

    def progress(left: float | None, last: MotifRecord | None) -> CampaignProgress:
        failed = sum(_reason(outcome) is not None for outcome in known.values())
        return CampaignProgress(len(known), len(inputs), failed, left, last)

    begin = progress(None, None)
    cells = [
        (inputs[sizes], (respond, plan.cell_design(sizes), plan.edge_mm, motif_code_version())) for sizes in missing
    ]
    with closing(solve_missing(kept, _solve_one, cells, jobs, dask, lambda: send_report(begin))) as solved:
        for number, outcome, left in solved:
            sizes = missing[number]
            known[sizes] = outcome
            send_report(progress(left, _record(plan, MotifTask(False, sizes), outcome)))
    return [_record(plan, task, known[task.sizes]) for task in tasks]


@functools.cache
def motif_code_version() -> str:
    """Hash of the sources; the same wherever the same code is installed."""
    return sources_hash(MOTIF_SOURCES)


def sizes_label(plan: MotifPlan, sizes: tuple[float, ...]) -> str:
    """The sizes of a cell that vary in a plan, in one line; all of them if none does."""
    pairs = list(zip(plan.sizes, sizes, strict=True))
    shown = [pair for pair in pairs if pair[0].varies] or pairs
    return ", ".join(f"{size.key.removesuffix('_mm')} {value:.6g} mm" for size, value in shown) or "the motif"


def _record(plan: MotifPlan, task: MotifTask, outcome: Outcome) -> MotifRecord:
    responses = None if outcome.sample is None else outcome.sample["responses"]
    label = sizes_label(plan, task.sizes)
    return MotifRecord(task, label, responses, _reason(outcome), outcome.crashed, outcome.seconds)


def _reason(outcome: Outcome) -> str | None:
    """Why a cell has no law: it has no answer, or does not stand for a sheet."""
    if outcome.sample is None:
        return outcome.failed or "no answer"
    return None if not outcome.sample["doubts"] else str(outcome.sample["doubts"][0])


def _inputs(plan: MotifPlan, task: MotifTask, respond: SolveMotif) -> dict[str, Any]:
    design = plan.cell_design(task.sizes).to_dict()
    parts = {name: design[name] for name in ("fabric", "plastic", "lattice", "rods")}
    other = {} if respond is motif_responses else {"respond": f"{respond.__module__}.{respond.__qualname__}"}
    return {**parts, "edge_mm": plan.edge_mm, **other}


def _solve_one(respond: SolveMotif, design: Design, edge_mm: float, code: str) -> Outcome:
    """Solve one cell in a worker."""

    def solve() -> tuple[dict[str, Any] | None, str | None]:
        if code != motif_code_version():
            raise RuntimeError("the worker has another version of asterism")
        responses = respond(design, edge_mm)
        return {"responses": responses_to_data(responses), "doubts": responses.doubts}, None

    return attempt(solve, DesignError, MeshError, ArithmeticError, np.linalg.LinAlgError)
