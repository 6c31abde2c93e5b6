"""The law of a preview of a motif to which none is given: from the design's file, or from cells that are solved now."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from asterism.equilibrium.errors import Error
from asterism.homogenize.campaign.design_plan import geometric_nodes
from asterism.homogenize.campaign.fit_motif_law import fit_motif_law
from asterism.homogenize.campaign.motif_campaign import MotifRecord, sizes_label
from asterism.homogenize.campaign.motif_design_plan import LIMITS_MM, MAX_NODE_RATIO, plan_for_motif
from asterism.homogenize.campaign.motif_sample import responses_to_data
from asterism.homogenize.cell.motif_responses import MotifResponses, motif_responses
from asterism.homogenize.errors import CampaignError, LawError
from asterism.homogenize.law.motif_law import MotifLaw, problem_of_motif
from asterism.homogenize.law.motif_law_file import load_motif_law
from asterism.homogenize.law.motif_plan import MotifPlan, MotifSize, MotifTask
from asterism.pattern.design.design import Design, leading_field
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.layout import Layout

# after an edit of a size, the law covers its new value times and over this factor, so that further edits are quick
EDIT_REACH = 1.25
# cells that are kept for further laws
MAX_KEPT_CELLS = 500
EXACT_ADVICE = "use the exact model: asterism simulate"

Solve = Callable[[Design, float, Callable[[str], None]], MotifResponses]
_kept: dict[str, tuple[MotifResponses | None, str | None]] = {}


def solve_motif_cell(design: Design, edge_mm: float, say: Callable[[str], None]) -> MotifResponses:
    """`motif_responses` with its usual directions."""
    return motif_responses(design, edge_mm, say=say)


def serving_motif_law(
    design: Design,
    plan: Layout,
    known: object = None,
    say: Callable[[str], None] = lambda text: None,
    solve: Solve = solve_motif_cell,
) -> MotifLaw:
    """The law for the motif of a design, also while its sizes are edited.

    A law that covers the design is taken as it is. If only sizes leave its range, the new law has the cells of the old
    one, and further ones around the new sizes; cells are solved once in a process.

    Parameters
    ----------
    plan : layout of the design.
    known : law of the preview before an edit.
    say : called with a line before each cell, and for each of its directions.
    solve : solves a cell.

    Raises
    ------
    DesignError
        There is no law of such a design.
    LawError
        The cells have no law, or the design's file is no law for it; the message has the reason.
    """
    if design.law_file is not None:
        law = load_motif_law(design.law_file)
        law.check(design)
        return law
    own = replace(plan_for_motif(design), held_out=0)
    if isinstance(known, MotifLaw):
        if _covers(known, design, plan):
            return known
        own = _around(own, known.plan) or own
    records = list(_solved(own, say, solve))
    try:
        return fit_motif_law(own, records)
    except CampaignError as error:
        reason = next((record.failed for record in records if record.failed), str(error))
        message = problem_of_motif(reason)
        raise LawError(f"{message}; {EXACT_ADVICE}", field=leading_field(message)) from None


def _covers(law: MotifLaw, design: Design, plan: Layout) -> bool:
    """Whether a law serves all places of a sheet."""
    try:
        law.check(design)
        return bool(law.evaluate_at(design, np.concatenate([plan.outline, plan.points_on_rods])).inside.all())
    except LawError:
        return False


def _around(own: MotifPlan, known: MotifPlan) -> MotifPlan | None:
    """The cells of a design and those of a law before it, with room around sizes that an edit has changed.

    None if these are for another motif, lattice or material.
    """
    if own.edge_mm != known.edge_mm or [(s.key, s.lines) for s in own.sizes] != [(s.key, s.lines) for s in known.sizes]:
        return None
    if _without_sizes(own) != _without_sizes(known):
        return None
    sizes = tuple(_joined(new, old) for new, old in zip(own.sizes, known.sizes, strict=True))
    return replace(own, sizes=sizes)


def _without_sizes(plan: MotifPlan) -> str:
    """All that a cell depends on but for the sizes over which the law is tabulated."""
    data = plan.design.to_dict()
    data.pop("name")
    for size in plan.sizes:
        for line in size.lines:
            data["rods"]["motif"][line].pop(size.key)
    return json.dumps(data, sort_keys=True)


def _joined(new: MotifSize, old: MotifSize) -> MotifSize:
    """The nodes of a size before an edit, and those that reach beyond its new values."""
    low, high = old.nodes[0], old.nodes[-1]
    if low <= new.nodes[0] and new.nodes[-1] <= high:
        return old
    least, most = LIMITS_MM[new.key]
    bottom = low if low <= new.nodes[0] else max(least, new.nodes[0] / EDIT_REACH)
    top = high if new.nodes[-1] <= high else min(most, new.nodes[-1] * EDIT_REACH)
    nodes = set(old.nodes)
    for ends in ((bottom, low), (high, top)):
        nodes |= set(geometric_nodes(np.array(ends), MAX_NODE_RATIO[new.key]))
    return replace(new, nodes=tuple(sorted(nodes)))


def _solved(plan: MotifPlan, say: Callable[[str], None], solve: Solve) -> Iterator[MotifRecord]:
    """The records of a plan's cells, solved in this process."""
    tasks = plan.tasks()
    missing = [task for task in tasks if _key(plan, task, solve) not in _kept]
    for number, task in enumerate(missing, 1):
        label = f"cell {number} of {len(missing)}, {sizes_label(plan, task.sizes)}"
        answer = _answer(plan, task, partial(_say_of_cell, say, label), solve)
        while len(_kept) >= MAX_KEPT_CELLS:
            del _kept[next(iter(_kept))]
        _kept[_key(plan, task, solve)] = answer
    for task in tasks:
        responses, problem = _kept[_key(plan, task, solve)]
        sample = None if responses is None else responses_to_data(responses)
        yield MotifRecord(task, sizes_label(plan, task.sizes), sample, problem, False, 0.0)


def _say_of_cell(say: Callable[[str], None], label: str, text: str) -> None:
    say(f"{label}: {text}")


def _answer(
    plan: MotifPlan, task: MotifTask, say: Callable[[str], None], solve: Solve
) -> tuple[MotifResponses | None, str | None]:
    """The responses of a cell, and why it has no law."""
    try:
        responses = solve(plan.cell_design(task.sizes), plan.edge_mm, say)
    except (ArithmeticError, np.linalg.LinAlgError, DesignError, Error) as error:
        return None, str(error)
    return responses, responses.doubts[0] if responses.doubts else None


def _key(plan: MotifPlan, task: MotifTask, solve: Solve) -> str:
    data = plan.cell_design(task.sizes).to_dict()
    parts = {name: data[name] for name in ("fabric", "plastic", "lattice", "rods")}
    return json.dumps(parts | {"edge_mm": plan.edge_mm, "solve": solve.__qualname__})
