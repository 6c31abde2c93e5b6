"""The campaign of the universal law: spread cells, then refined ones where the law is worst, in a fixed order.

The plan depends on nothing but the numbers of cells and the answers of earlier ones. So a campaign that was killed
and continues gives the same law, and so does a campaign on a cluster.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.campaign.campaign import CampaignProgress
from asterism.homogenize.campaign.code_version import code_version
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.universal.refined_cells import refined_groups
from asterism.homogenize.universal.row_names import ROW_NAMES
from asterism.homogenize.universal.solve_cells import SolveGroups, solve_cells, solve_groups
from asterism.homogenize.universal.solved_cells import SolvedCells
from asterism.homogenize.universal.spread_cells import spread_groups
from asterism.homogenize.universal.universal_law import UniversalLaw, universal_law

# relative difference of a cell that is solved again; rounding of another machine
REPEAT_TOLERANCE = 1e-4
# cells of a file from other code that are solved again before the rest is used
REPEATED_CELLS = 2


@dataclass(frozen=True)
class UniversalPlan:
    """Numbers of cells.

    Attributes
    ----------
    spread : over the whole range.
    rounds : of refinement; each fits a law to all cells before it.
    refined : cells of each round.
    """

    spread: int
    rounds: int = 0
    refined: int = 500


def run_universal_campaign(
    plan: UniversalPlan,
    folder: Path,
    start: UniversalLaw | None = None,
    jobs: int = 1,
    dask: str | None = None,
    made: dict[str, Any] | None = None,
    report: Callable[[CampaignProgress], None] | None = None,
    solve: SolveGroups = solve_groups,
) -> UniversalLaw:
    """Solve the cells of a plan and fit the law.

    Parameters
    ----------
    folder : of finished cells.
    start : a law whose cells are not solved again. As many of its rounds of refined cells as the plan has are kept.
    jobs, dask, report, solve : as of `solve_cells`.
    made : origin of the law; the version of the code is added.

    Raises
    ------
    CampaignError
        Too few cells have an answer, the workers have ended, or the cells of `start` differ from those of this code.
    AddressError
        The scheduler does not answer.
    """
    known = None if start is None else start.cells
    code = code_version()
    if start is not None and start.made.get("code") != code:
        _check_repeats(start.cells, solve)
    cells = solve_cells(spread_groups(plan.spread), folder, known, jobs, dask, report, solve)
    origin = {**(made or {}), "code": code, "plan": vars(plan)}
    kept = SolvedCells.none() if start is None else start.cells[start.spread_count :]
    done = min(plan.rounds, len(kept) // plan.refined)
    cells = cells + kept[: done * plan.refined]
    for _ in range(plan.rounds - done):
        law = universal_law(cells, plan.spread)
        cells = cells + solve_cells(refined_groups(law, plan.refined), folder, known, jobs, dask, report, solve)
    return universal_law(cells, plan.spread, origin)


def _check_repeats(cells: SolvedCells, solve: SolveGroups) -> None:
    """Raise CampaignError if the cheapest cells have other answers with this code."""
    usable = np.flatnonzero(cells.usable)
    for number in usable[np.argsort(cells.seconds[usable], kind="stable")][:REPEATED_CELLS]:
        sample, _ = solve(cells.groups[number].tolist())
        again = np.full(len(ROW_NAMES), np.nan) if sample is None else np.array(sample["row"])
        size = np.maximum(np.abs(cells.rows[number]), 1e-3)
        if not np.all(np.abs(again - cells.rows[number]) <= REPEAT_TOLERANCE * size):
            raise CampaignError(
                "the cells of the law are of code with other answers; --afresh solves all of them again"
            )
