"""The law of a preview from cells that are solved now, or were solved before on this machine."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from asterism.homogenize.campaign.campaign import SampleRecord, SolveCell, run_campaign
from asterism.homogenize.campaign.design_plan import plan_for_design
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.campaign.kept_samples import cells_folder, forget_oldest
from asterism.homogenize.campaign.workers import CampaignProgress, default_jobs
from asterism.homogenize.errors import CampaignError, LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.motif_law import MotifLaw, problem_of_motif
from asterism.homogenize.law.plan import Sizes
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design, leading_field
from asterism.pattern.layout.layout import Layout
from asterism.process.listeners import Say

EXACT_ADVICE = "use the exact model: asterism simulate"


def learned_law(
    design: Design, sheet: Layout, before: Law[Any] | None, say: Say, respond: SolveCell | None = None
) -> StarLaw | MotifLaw:
    """The law of cells around the sizes of a design, with those of a law before an edit.

    Parameters
    ----------
    sheet : layout of the design.
    before : its cells stay if it is of the same material and pattern.
    say : called with a line before each cell that is solved.
    respond : solves a cell, as of `run_campaign`.

    Raises
    ------
    DesignError
        There is no law of such a design.
    LawError
        The cells have no answer; the message has the reason.
    """
    same, cells = None, set[Sizes]()
    if before is not None:
        try:
            before.plan.check(design)
            before.at(design.fabric.stretch_xy)
            same, cells = before.plan, {tuple(each[name] for name in before.plan.names) for each in before.samples}
        except LawError:
            pass
    plan = replace(plan_for_design(design, sheet, same), held_out=0)
    tasks = plan.tasks_for_sizes(plan.sizes_on(design, sheet), cells)
    records: list[SampleRecord] = []
    solved_before = 0

    def report(progress: CampaignProgress) -> None:
        nonlocal solved_before
        solved_before = solved_before if progress.last else progress.done
        if progress.done < progress.total:
            left = progress.seconds_left
            seconds = "" if left is None else f", about {np.ceil(left):.0f} s"
            number, count = progress.done - solved_before + 1, progress.total - solved_before
            say(f"learning this fabric: cell {number} of {count}{seconds}")

    try:
        folder = cells_folder()
        records = run_campaign(plan, folder, default_jobs(), report=report, respond=respond, tasks=tasks)
        if solved_before < len(records):
            forget_oldest(folder)
        return fit_law(plan, records)
    except CampaignError as error:
        if design.rods is None:
            raise LawError(f"{error}; {EXACT_ADVICE}") from None
        message = problem_of_motif(next((record.failed for record in records if record.failed), str(error)))
        raise LawError(f"{message}; {EXACT_ADVICE}", field=leading_field(message)) from None
