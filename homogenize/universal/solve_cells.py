"""The campaign that solves cells of the universal law."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.campaign import CampaignProgress
from asterism.homogenize.campaign.code_version import code_version
from asterism.homogenize.campaign.kept_samples import KeptSamples, Outcome, attempt
from asterism.homogenize.campaign.sample_rows import sample_quantities
from asterism.homogenize.campaign.workers import solve_missing
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.cell.tube_directions import THREEFOLD_ANGLES_RAD
from asterism.homogenize.universal.groups import GROUP_KEYS, REFERENCE_MODULUS_MPA, REFERENCE_SPACING_MM, reference_cell
from asterism.homogenize.universal.solved_cells import ANISOTROPY, ROW_NAMES, SolvedCells, quantity_scales
from asterism.pattern.design.errors import DesignError, MeshError

# the law holds the mean over these directions, and the difference between them
_ANGLES = (THREEFOLD_ANGLES_RAD[0], THREEFOLD_ANGLES_RAD[-1])
SolveGroups = Callable[[list[float]], tuple[dict[str, Any] | None, str | None]]
# cells of stars that keep their symmetry are isotropic up to rounding; those whose fabric buckles between stars are not
MAX_ANISOTROPY = 0.02
# natural curvature times spacing, above which stars wrap and a law has no use
MAX_USEFUL_CURL = 3.0


def solve_groups(groups: list[float]) -> tuple[dict[str, Any] | None, str | None]:
    """Solve the reference cell of these groups: its row and its problem as plain data, and why there is no answer."""
    row = np.array(groups)
    sample = solve_cell(*reference_cell(row), _ANGLES).to_dict()
    if sample["failed"]:
        return None, sample["failed"]
    answer = _cell_row(sample, row)
    problem = _row_problem(answer, min(sample["natural_bump_mm"]) / REFERENCE_SPACING_MM)
    return {"row": answer.tolist(), "problem": problem}, None


def solve_cells(
    groups: Floats,
    folder: Path,
    known: SolvedCells | None = None,
    jobs: int = 1,
    dask: str | None = None,
    report: Callable[[CampaignProgress], None] | None = None,
    solve: SolveGroups = solve_groups,
) -> SolvedCells:
    """The answers of cells with these groups (n, G), in this order; only those that are missing are solved.

    Parameters
    ----------
    folder : of finished cells, one file each; an interrupted campaign continues from there.
    known : cells of a law's file, which are not solved again.
    jobs, dask, report : as of `homogenize.campaign.campaign.run_campaign`.
    solve : solves a cell. Other processes must be able to import it.

    Raises
    ------
    CampaignError, AddressError
        As of `run_campaign`.
    """
    keys = [tuple(row) for row in groups.tolist()]
    kept = KeptSamples(folder, code_version())
    outcomes = _outcomes(known or SolvedCells.none())
    for key in keys:
        if key not in outcomes and (outcome := kept.read(_inputs(key, solve))) is not None:
            outcomes[key] = outcome
    missing = list(dict.fromkeys(key for key in keys if key not in outcomes))
    send = report or (lambda progress: None)
    before = len(keys) - len(missing)
    begin = _progress(before, len(keys), keys, outcomes, None)
    cells = [(_inputs(key, solve), (solve, list(key), code_version())) for key in missing]
    with closing(solve_missing(kept, _solve_kept, cells, jobs, dask, lambda: send(begin))) as solved:
        for count, (number, outcome, left) in enumerate(solved, 1):
            outcomes[missing[number]] = outcome
            send(_progress(before + count, len(keys), keys, outcomes, left))
    return _cells(groups, [outcomes[key] for key in keys])


def _solve_kept(solve: SolveGroups, groups: list[float], code: str) -> Outcome:
    """Solve one cell in a worker."""

    def answer() -> tuple[dict[str, Any] | None, str | None]:
        if code != code_version():
            raise RuntimeError("the worker has another version of asterism")
        return solve(groups)

    return attempt(answer, DesignError, MeshError, ArithmeticError, np.linalg.LinAlgError)


def _inputs(key: tuple[float, ...], solve: SolveGroups) -> dict[str, Any]:
    return {"groups": list(key), "respond": f"{solve.__module__}.{solve.__qualname__}"}


def _outcomes(cells: SolvedCells) -> dict[tuple[float, ...], Outcome]:
    """Cells of a law's file as outcomes by their groups."""
    found = {}
    for groups, row, problem, seconds in zip(
        cells.groups.tolist(), cells.rows, cells.problems, cells.seconds.tolist(), strict=True
    ):
        has_answer = bool(np.isfinite(row).all())
        sample = {"row": row.tolist(), "problem": problem or None} if has_answer else None
        found[tuple(groups)] = Outcome(sample, None if has_answer else problem, False, seconds)
    return found


def _cells(groups: Floats, outcomes: list[Outcome]) -> SolvedCells:
    rows = np.full((len(groups), len(ROW_NAMES)), np.nan)
    problems = []
    for number, outcome in enumerate(outcomes):
        if outcome.sample is None:
            problems.append(outcome.failed or "no answer")
        else:
            rows[number] = outcome.sample["row"]
            problems.append(outcome.sample["problem"] or "")
    return SolvedCells(groups, rows, tuple(problems), np.array([outcome.seconds for outcome in outcomes]))


def _progress(
    done: int, total: int, keys: list[tuple[float, ...]], outcomes: dict[tuple[float, ...], Outcome], left: float | None
) -> CampaignProgress:
    failed = sum(outcomes[key].failed is not None for key in keys if key in outcomes)
    return CampaignProgress(done, total, failed, left, None)


def _cell_row(sample: Mapping[str, Any], groups: Floats) -> Floats:
    """(R,) the dimensionless values of `ROW_NAMES`, from the sample of a reference cell with these groups (G,)."""
    stretch, plate = (float(groups[GROUP_KEYS.index(key)]) for key in ("stretch", "fabric"))
    force, d = REFERENCE_MODULUS_MPA * plate * REFERENCE_SPACING_MM, REFERENCE_SPACING_MM
    quantities = sample_quantities(dict(sample), stretch) / quantity_scales(d, force)
    waves = np.array(sample["relief"], dtype=float) / np.array([[d], [d**2]])
    eigenvalues = [sample["supercell_eigenvalue"] / force, min(sample["natural_supercell_eigenvalue"]) / force]
    return np.concatenate([quantities, waves.ravel(), eigenvalues, [sample["anisotropy"]]])


def _row_problem(row: Floats, bump: float) -> str | None:
    """Why a cell cannot make the law, in one line; None if it can.

    Parameters
    ----------
    bump : smallest height of the star's centre over its tips on the natural tubes, over the spacing.
    """
    values = dict(zip(ROW_NAMES, row, strict=True))
    if not np.isfinite(row).all() or not all(values[name] > 0.0 for name in ("lam", "lam_n", "bending", "a11")):
        return "a response is no answer"
    if values[ANISOTROPY] > MAX_ANISOTROPY:
        return "the fabric buckles between the stars"
    if not bump > 0.0:
        return "the star is not up"
    if abs(values["kappa"]) > MAX_USEFUL_CURL:
        return "the star wraps"
    return None
