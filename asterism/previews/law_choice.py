"""The law of a preview to which none is given: the design's, the paper's, or one of cells solved now."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism.homogenize.errors import CampaignError, LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.motif_law import MotifLaw, problem_of_motif
from asterism.homogenize.law.plan import SampleRecord, Sizes, without_law
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design, leading_field
from asterism.pattern.design.files import file_identity
from asterism.pattern.design.stars import ROD_SIZES
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.process.progress import Say, ignore_line

if TYPE_CHECKING:
    from asterism.homogenize.campaign.campaign import SolveCell
    from asterism.homogenize.campaign.workers import CampaignProgress


@cache
def paper_law() -> StarLaw:
    """The law that comes with the package, read once."""
    return load_law()


def law_of(design: Design) -> Law[Any]:
    """The law that the section `[material]` of a design names, or else the paper's.

    A file is read again only if it has changed: the designs of a sweep name the same one.

    Raises LawError: the file is not a law.
    Raises UnreadableLaw: the file is missing, or cannot be read.
    """
    if design.law_file is None:
        return paper_law()
    try:
        identity = file_identity(design.law_file)
    except OSError:
        return load_law(design.law_file)  # raises the error that names the file
    return _law_in(design.law_file, identity)


@lru_cache(maxsize=4)
def _law_in(path: str, identity: tuple[int, ...]) -> Law[Any]:
    return load_law(path)


def serving_law(
    design: Design,
    plan: Layout | None = None,
    known: object = None,
    say: Say = ignore_line,
    respond: SolveCell | None = None,
) -> Any:
    """The law that a design names, or else the paper's if it covers the stars, or else one of cells solved now.

    Cells are kept (`homogenize.campaign.kept_samples`): each is solved once on a machine.

    `plan`: layout of the design; computed if it is needed; `known`: law of the preview before an edit. A law that
    covers the design stays; one of the same material and pattern gets further cells; `say`: called with a line before
    each cell that is solved; `respond`: solves a cell, as of `run_campaign`.

    Returns a `StarLaw` or a `MotifLaw`, as the design has stars or a motif.

    Raises DesignError: there is no law of such a design.
    Raises LawError: the file that the design names is no law for it, or the cells have no answer; the message has the
    reason.
    """
    named = law_of(design) if design.law_file is not None or design.rods is None else None
    if named is not None and (design.law_file is not None or without_law(design) is not None):
        named.check(design)
        return named
    sheet = plan if plan is not None else layout(design)
    before = known if isinstance(known, Law) and known is not named else None
    for law in (named, before):
        if law is not None and law.covers(design, sheet):
            return law
    return _learned_law(design, sheet, before, say, respond)


def law_around(design: Design, *others: Design) -> Any:
    """The law of cells around the sizes of a design and of others that differ from it in their sizes only.

    Raises LawError: the cells have no answer.
    """
    return _learned_law(design, layout(design), None, ignore_line, None, tuple(layout(each) for each in others))


def _learned_law(
    design: Design,
    sheet: Layout,
    before: Law[Any] | None,
    say: Say,
    respond: SolveCell | None,
    others: tuple[Layout, ...] = (),
) -> StarLaw | MotifLaw:
    """The law of cells around the sizes of a design; a law `before` an edit keeps its cells if it is of its pattern."""
    # these load the exact model
    from asterism.homogenize.campaign.campaign import run_campaign
    from asterism.homogenize.campaign.design_plan import plan_for_sizes, sizes_on
    from asterism.homogenize.campaign.fit_law import fit_law
    from asterism.homogenize.campaign.kept_samples import cells_folder, forget_oldest
    from asterism.homogenize.campaign.workers import default_jobs

    same, cells = None, set[Sizes]()
    if before is not None:
        try:
            before.plan.check(design)
            before.at(design.fabric.stretch_xy)
            same = before.plan
            # a law that was made before a size was known is for its usual value
            usual: dict[str, float] = {size.key: size.usual for size in ROD_SIZES}
            cells = {
                tuple(each[name] if name in each else usual[name] for name in same.names) for each in before.samples
            }
        except LawError:
            pass
    sizes = np.concatenate([sizes_on(design, each) for each in (sheet, *others)])
    plan = replace(plan_for_sizes(design, sizes, same), held_out=0)
    tasks = plan.tasks_for_sizes(sizes, cells)
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
        message, field = str(error), ""
        if design.rods is not None:
            message = problem_of_motif(next((record.failed for record in records if record.failed), message))
            field = leading_field(message)
        raise LawError(f"{message}; use the exact model: asterism simulate", field=field) from None
