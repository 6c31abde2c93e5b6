"""The campaign of the universal law: spread cells, then refined ones where the law is worst, in a fixed order.

The plan depends on nothing but the numbers of cells and the answers of earlier ones. So a campaign that was killed
and continues gives the same law, and so does a campaign on a cluster.

The first cells are spread evenly over the range of the law by a Sobol sequence. The sequence has no end, and a longer
list begins with the shorter one. So a campaign can be extended at any time, and its finished cells stay in the plan.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.campaign import CampaignProgress
from asterism.homogenize.campaign.code_version import code_version
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from asterism.homogenize.universal.groups import GROUP_KEYS, GROUPS, MAX_ARM_CURL, MIN_FABRIC_TO_EDGE, arm_curl
from asterism.homogenize.universal.law_errors import left_out_errors
from asterism.homogenize.universal.solve_cells import SolveGroups, solve_cells, solve_groups
from asterism.homogenize.universal.solved_cells import ROW_NAMES, SolvedCells
from asterism.homogenize.universal.universal_law import UniversalLaw, kriging_places, universal_law

# relative difference of a cell that is solved again; rounding of another machine
REPEAT_TOLERANCE = 1e-4
# cells of a file from other code that are solved again before the rest is used
REPEATED_CELLS = 2
# of the sequence that candidates come from; the law's own cells have another one
CANDIDATE_SEED = 1
# candidates for each new cell
CANDIDATES_PER_CELL = 16
# cells whose left-out errors count at a candidate
NEIGHBOURS = 6
# errors count up to this, %: one cell on another branch must not draw all others
MAX_COUNTED_ERROR_PERCENT = 50.0
# quantities whose errors count, and their weights: contraction has to be known ten times better than the others
COUNTED_QUANTITIES = {"lam_n": 10.0, "kappa": 1.0, "bending": 1.0}
# mesh edges between two stars; coarse meshes are cheap, and the answers vary evenly from mesh to mesh
EDGES_BETWEEN_STARS = (10, 12, 15, 20)
# points of the sequence that are drawn at a time, a power of two
_BLOCK = 1024
_ARM, _FABRIC, _EDGE = (GROUP_KEYS.index(key) for key in ("arm", "fabric", "edge"))


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
        cells = cells + solve_cells(_refined_groups(law, plan.refined), folder, known, jobs, dask, report, solve)
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


def _refined_groups(law: UniversalLaw, count: int) -> Floats:
    """(count, G) groups of new cells, the most useful first. Equal laws give equal cells.

    The use of a candidate is the error that its neighbours in the law have when they are left out, times its distance
    to the nearest solved cell, also among those chosen before. Candidates that would wrap are left out.
    """
    pool = spread_groups(CANDIDATES_PER_CELL * count, CANDIDATE_SEED)
    curl = np.abs(law(pool)[:, QUANTITY_NAMES.index("kappa")])
    pool = pool[curl <= MAX_SEPARATED_CURL]
    lengths = law.parts["kappa"].covariance.lengths
    places = kriging_places(pool) / lengths
    errors = left_out_errors(law)
    columns = [QUANTITY_NAMES.index(name) for name in COUNTED_QUANTITIES]
    worst = (errors.percent[:, columns] * np.array(list(COUNTED_QUANTITIES.values()))).max(axis=1)
    counted = np.minimum(worst, MAX_COUNTED_ERROR_PERCENT)
    near = law.nearest_cells(pool, NEIGHBOURS)
    error = np.where(errors.separated[near], counted[near], 0.0).mean(axis=1)
    distance = cKDTree(kriging_places(law.cells.groups) / lengths).query(places)[0]
    chosen = []
    for _ in range(min(count, len(pool))):
        best = int(np.argmax(error * distance))
        chosen.append(best)
        distance = np.minimum(distance, np.linalg.norm(places - places[best], axis=1))
    return pool[chosen]


def spread_groups(count: int, seed: int = 0) -> Floats:
    """(count, G) groups of the first cells. Every cell needs a single mesh: its arms are a whole number of edges long.

    Parameters
    ----------
    seed : of the scrambled sequence; another seed gives cells that can test a law of the first ones.

    Examples
    --------
    >>> few, more = spread_groups(3), spread_groups(5)
    >>> bool((few == more[:3]).all()), more.shape
    (True, (5, 8))
    """
    from scipy.stats import qmc  # its import takes half a second, and only campaigns use it

    engine = qmc.Sobol(len(GROUPS), seed=np.random.default_rng(seed))
    rows = np.empty((0, len(GROUPS)))
    while len(rows) < count:
        groups = _groups_at(engine.random(_BLOCK))
        rows = np.vstack([rows, groups[arm_curl(groups) <= MAX_ARM_CURL]])
    return rows[:count]


def _groups_at(points: Floats) -> Floats:
    """(n, G) groups of points (n, G) in the unit cube, with a whole number of mesh edges on arms and between stars."""
    groups = np.column_stack([group.at_coordinate(points[:, n]) for n, group in enumerate(GROUPS)])
    # the meshes that are fine enough for a fabric have equal shares of its cells
    first = np.searchsorted(EDGES_BETWEEN_STARS, MIN_FABRIC_TO_EDGE / groups[:, _FABRIC])
    left = len(EDGES_BETWEEN_STARS) - first
    edges = np.array(EDGES_BETWEEN_STARS)[first + np.minimum((points[:, _EDGE] * left).astype(int), left - 1)]
    shortest, longest = GROUPS[_ARM].limits
    along = np.clip(np.rint(groups[:, _ARM] * edges), np.ceil(shortest * edges), np.floor(longest * edges + 1e-9))
    groups[:, _ARM] = along / edges
    groups[:, _EDGE] = 1.0 / edges
    return np.round(groups, 12)
