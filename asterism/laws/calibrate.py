"""`asterism calibrate`: a campaign of unit cells of a star or a motif, the law from their samples, and it in words."""

from __future__ import annotations

import os
import platform
import time
from collections import Counter
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from asterism.homogenize.campaign.campaign import SolveCell, run_campaign
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.campaign.kept_samples import cells_folder, code_version
from asterism.homogenize.cell.point_group import MIN_RESOLVED_CURL, differs_by_direction
from asterism.homogenize.law.anisotropy import predicted_curvatures
from asterism.homogenize.law.law import Law, LawTable
from asterism.homogenize.law.law_file import law_bytes, law_digest
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import LawPlan, SampleRecord, stretch_text, without_law
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, StarLaw
from asterism.previews.model import PREVIEW_MODEL
from asterism.process.progress import CountLine, without_numbers
from asterism.process.version import __version__
from asterism.results.files import OutputError, check_writable, write_file
from asterism.results.records.material import LawRecord
from asterism.results.words import table_lines


def calibrate(
    plan: LawPlan,
    output: Path,
    jobs: int = 1,
    dask: str | None = None,
    command: str = "asterism in Python",
    stream: TextIO | None = None,
    respond: SolveCell | None = None,
) -> StarLaw | MotifLaw:
    """Solve the plan's cells, those that are not there yet, fit the law and write it.

    Parameters
    ----------
    plan : of a material or of a design, see `asterism.laws.from_files`.
    jobs : processes of this machine.
    dask : address of a scheduler to use in their place.
    command : that the law's file names as its origin.
    stream : where progress is printed; standard error by default.
    respond : solves a cell, as of `run_campaign`.

    Raises
    ------
    DesignError
        There is no law of such a material.
    AddressError
        No cluster answers at the address.
    CampaignError
        There is no law: too many cells without an answer, or workers that have ended.
    OutputError
        The law or a cell cannot be written.
    """
    if (refused := without_law(plan.design)) is not None:
        raise refused
    check_writable(output.parent, output.name)
    start, folder = time.perf_counter(), cells_folder()
    try:
        with CountLine("cells", stream) as watch:
            records = run_campaign(plan, folder, jobs, dask, watch.report, respond)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {(error.strerror or str(error)).lower()}") from None
    law = fit_law(plan, records, _origin(command, start, records))
    write_file(output, law_bytes(law))
    return law


def _origin(command: str, start: float, records: Sequence[SampleRecord]) -> dict[str, Any]:
    """What made a law, for its file."""
    return {
        "command": command,
        "code": code_version(),
        "versions": {"asterism": __version__, **{name: version(name) for name in ("numpy", "scipy", "numba")}},
        "machine": {"cores": os.cpu_count(), "machine": platform.machine(), "python": platform.python_version()},
        "cell_seconds": sum(record.seconds for record in records),
        "wall_seconds_of_last_run": time.perf_counter() - start,
    }


def law_record(law: Law[Any]) -> LawRecord:
    """The summary of a law."""
    plan = law.plan.to_dict()
    return LawRecord.from_json(
        {
            "plan": plan,
            "digest": law_digest(law),
            "made": law.made,
            "residuals": law.residuals,
            "stretches": plan["stretches"],
            "edge_mm": law.edge_mm,
            "cells": len(law.samples),
            "cells_without_law": [
                {name: value for name, value in sample.items() if name != "sample"}
                for sample in law.samples
                if sample["problem"] is not None
            ],
        }
    )


def law_lines(law: Law[Any]) -> list[str]:
    """The law as lines of text."""
    lines = table_lines(law_record(law).table(), 11)
    for table in law.tables:
        lines += _errors(law, table)
    said = [f"  {line}" for line in (directions_warning(law), held_out_warning(law)) if line]
    return [*lines, *([""] if said else []), *said, *_problems(law)]


def _errors(law: Law[Any], table: LawTable) -> list[str]:
    stretch = stretch_text(table.stretch)
    entry = law.residuals.get(stretch, {}).get("held_out", {})
    errors = entry.get("errors")
    if not errors:
        return []
    title = f"  stretch {stretch}: held out, {entry['count']} cells; error in % of the cell's value"
    if entry["tight"]["count"]:
        title += f"; {entry['tight']['count']} more are not scale-separated"
    lines = ["", title, f"  {'':11} median    rms  largest"]
    for name in table.error_names:
        e = errors[name]
        lines.append(f"    {name:<10} {e['median_percent']:5.2f} {e['rms_percent']:6.2f} {e['largest_percent']:8.2f}")
    return lines


def held_out_warning(law: Law[Any]) -> str | None:
    """A large error at the held-out cells, at the worst stretch, in one line; None without one."""
    checked = {"kappa": "curvature", "curvature": "curvature", "bending": "bending stiffness"}
    largest: list[tuple[float, str]] = []
    for stretch, kinds in law.residuals.items():
        errors = kinds["held_out"]["errors"]
        rms = {words: errors[name]["rms_percent"] for name, words in checked.items() if name in errors}
        worst = max(rms.values(), default=0.0)
        # rms over the held-out cells, above which a law warns
        if worst > 5.0:
            words = " and ".join(f"{percent:.0f} % in {what}" for what, percent in rms.items())
            largest.append((worst, f"at stretch {stretch} the law's error at its held-out cells is {words} (rms)"))
    return f"{max(largest)[1]}: a plan with more sizes makes it smaller" if largest else None


def directions_warning(law: Law[Any]) -> str | None:
    """How much previews misjudge natural curvatures that differ between directions, in one line; None if they do not.

    The numbers are those of the worst direction of each cell that curls and is scale-separated.
    """
    if not isinstance(law, StarLaw) or not differs_by_direction(law.plan.design):
        return None
    missing = "the stars curl and bend differently in each direction, which previews model in part"
    percent = []
    for cell in law.samples:
        if cell["problem"] is not None or cell["length_mm"] == 0.0:
            continue
        kappa = np.array(cell["sample"]["natural_curvature"])
        largest = float(np.abs(kappa).max())
        if MIN_RESOLVED_CURL < largest * cell["sample"]["spacing_mm"] < MAX_SEPARATED_CURL:
            off = predicted_curvatures(cell["sample"], PREVIEW_MODEL.anisotropy_share) - kappa
            percent.append(100.0 * float(np.abs(off).max()) / largest)
    if not percent:
        return missing
    return (
        f"{missing}: the natural curvature of the worst direction differs by {np.median(percent):.0f} % in the "
        f"median of {len(percent)} cells, by {max(percent):.0f} % at most"
    )


def _problems(law: Law[Any]) -> list[str]:
    """The reasons why cells have no law, without their numbers, and how often each occurs."""
    reasons = Counter(without_numbers(s["problem"]) for s in law.samples if s["problem"] is not None)
    lines = [f"    {count:4d}  {reason}" for reason, count in reasons.most_common()]
    return ["", "  cells without a law", *lines] if lines else []
