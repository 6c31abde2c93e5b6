"""`asterism law universal` and `asterism law errors`: the law of all fabrics, and its errors at left-out cells."""

from __future__ import annotations

import os
import platform
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import TextIO

import numpy as np

from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from asterism.homogenize.universal.groups import GROUPS
from asterism.homogenize.universal.law_errors import (
    DIMENSIONLESS_ERROR_FLOORS,
    MAX_SERVING_ERRORS_PERCENT,
    NEAREST_CELLS,
    SHARES_PERCENT,
    STATED_QUANTITIES,
    left_out_errors,
)
from asterism.homogenize.universal.solve_cells import SolveGroups, solve_groups
from asterism.homogenize.universal.universal_campaign import UniversalPlan, run_universal_campaign
from asterism.homogenize.universal.universal_law import UniversalLaw
from asterism.homogenize.universal.universal_law_file import (
    PACKAGED_UNIVERSAL_LAW,
    load_universal_law,
    universal_law_bytes,
)
from asterism.laws.calibrate import package_versions, solving_cells
from asterism.process.count_line import without_numbers
from asterism.results.files import write_file

_SERVING = ", ".join(f"{name} {most:g} %" for name, most in MAX_SERVING_ERRORS_PERCENT.items())


def make_universal_law(
    plan: UniversalPlan,
    output: Path,
    start: Path | None = None,
    jobs: int = 1,
    dask: str | None = None,
    stream: TextIO | None = None,
    solve: SolveGroups = solve_groups,
) -> UniversalLaw:
    """Solve the cells of a plan that are not there yet, fit the universal law and write it.

    Parameters
    ----------
    output : the file; finished cells are kept beside it, in a folder that ends with .samples.
    start : a universal law whose cells are not solved again.
    jobs, dask : processes of this machine, or the address of a Dask scheduler to use in their place.
    stream : where progress is printed; standard error by default.
    solve : solves a cell.

    Raises
    ------
    LawError
        `start` is no universal law.
    AddressError, CampaignError
        No cluster answers, or there is no law; see `run_universal_campaign`.
    OutputError
        The file or the folder cannot be written.
    """
    begun = None if start is None else load_universal_law(start)
    made = {
        "command": "asterism law universal",
        "versions": package_versions(),
        "machine": {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()},
    }
    with solving_cells(output, stream) as (folder, report):
        law = run_universal_campaign(plan, folder, begun, jobs, dask, made, report, solve)
    write_file(output, universal_law_bytes(law))
    return law


def universal_law_lines(path: Path | None = None) -> list[str]:
    """The range of a universal law and its errors at left-out cells, as lines of text.

    Parameters
    ----------
    path : of its file; the one that comes with the package by default.

    Raises
    ------
    LawError
        The file is no universal law.
    """
    law = load_universal_law(path or PACKAGED_UNIVERSAL_LAW)
    errors = left_out_errors(law)
    lines = [f"  {group.name:<30} {group.limits[0]:g} to {group.limits[1]:g}" for group in GROUPS]
    for served_only, which in ((False, "spread over this range"), (True, "of these that the law serves")):
        counted = int(errors.counted(served_only).sum())
        lines += ["", f"  left out one by one, {counted} cells {which}; error in % of the cell's value", ""]
        lines += [f"  {'':10}" + "".join(f"{f'{share} % of cells':>15}" for share in SHARES_PERCENT)]
        for name, row in errors.table(served_only).items():
            lines.append(f"  {name:<10}" + "".join(f"{value:15.2f}" for value in row))
    floors = ", ".join(f"{name} {floor:g}" for name, floor in DIMENSIONLESS_ERROR_FLOORS.items())
    lines += [
        "",
        f"  errors of small values are in % of these: {floors} (without dimension)",
        f"  cells with a natural curvature above {MAX_SEPARATED_CURL:g} over the spacing do not count",
        f"  the law serves where half of the {NEAREST_CELLS} nearest other cells count and are off by at most "
        f"{_SERVING} (rms)",
        "",
        *_by_fabric(law),
        "",
        *_origin(law),
    ]
    return lines


def _by_fabric(law: UniversalLaw) -> list[str]:
    """Median errors in four classes of the fabric's thickness, on which they depend most."""
    errors, columns = left_out_errors(law), [QUANTITY_NAMES.index(name) for name in STATED_QUANTITIES]
    number = next(n for n, group in enumerate(GROUPS) if group.key == "fabric")
    group = GROUPS[number]
    ends = group.at_coordinate(np.linspace(0.0, 1.0, 5))
    lines = [f"  {group.name:<30} {'lam_n':>8} {'kappa':>8} {'bending':>8}   median, %"]
    for low, high in pairwise(ends.tolist()):
        within = (law.groups[:, number] >= low) & (law.groups[:, number] <= high)
        chosen = errors.percent[errors.separated & errors.spread & within]
        if len(chosen):
            median = np.median(chosen[:, columns], axis=0)
            text = f"{low:.3f} to {high:.3f}, {len(chosen)} cells"
            lines.append(f"  {text:<30}" + "".join(f" {value:8.2f}" for value in median))
    return lines


def _origin(law: UniversalLaw) -> list[str]:
    plan, versions = law.made.get("plan", {}), law.made.get("versions", {})
    usable = int(law.cells.usable.sum())
    seconds = float(law.cells.seconds.sum())
    lines = [
        f"  cells   {len(law.cells)}, {law.spread_count} of them spread evenly; {usable} make the law; {seconds:.0f} s",
        f"  made by {law.made.get('command', '-')} (asterism {versions.get('asterism', '-')}), "
        f"code {law.made.get('code', '-')}, plan {plan}",
    ]
    reasons = Counter(without_numbers(problem) for problem in law.cells.problems if problem)
    lines += [f"  {count:6d}  {reason}" for reason, count in reasons.most_common()]
    return lines
