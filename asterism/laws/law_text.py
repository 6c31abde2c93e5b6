"""A law as lines of text: what it is for, its errors, the cells without a law, and warnings."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.cell.point_group import MIN_RESOLVED_CURL, differs_by_direction
from asterism.homogenize.law.anisotropy import predicted_curvatures
from asterism.homogenize.law.law import Law, LawTable
from asterism.homogenize.law.law_file import PAPER_LAW, law_digest, load_law
from asterism.homogenize.law.plan import stretch_text
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, StarLaw
from asterism.previews.model import PREVIEW_MODEL
from asterism.process.progress_line import without_numbers
from asterism.results.files import check_writable, staged_result
from asterism.results.records.law import LawRecord
from asterism.results.words import table_lines

# rms over the held-out cells, above which a law warns
MAX_HELD_OUT_ERROR_PERCENT = 5.0
CHECKED_QUANTITIES = {"kappa": "curvature", "curvature": "curvature", "bending": "bending stiffness"}


def law_record(law: Law[Any]) -> LawRecord:
    """The summary of a law.

    Examples
    --------
    >>> from asterism.homogenize.law.law_file import load_law
    >>> law_record(load_law()).table()["stretches"]
    '1.35, 1.75'
    """
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
    largest: list[tuple[float, str]] = []
    for stretch, kinds in law.residuals.items():
        errors = kinds["held_out"]["errors"]
        rms = {words: errors[name]["rms_percent"] for name, words in CHECKED_QUANTITIES.items() if name in errors}
        worst = max(rms.values(), default=0.0)
        if worst > MAX_HELD_OUT_ERROR_PERCENT:
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


def show_law(path: Path | None, output: Path | None) -> list[str]:
    """Write law.png and summary.json; the lines to print.

    Parameters
    ----------
    path : of the law; None for the paper's.
    output : the folder; by default beside the law.

    Raises
    ------
    LawError
        The file is not a law, or has another format.
    """
    from asterism.laws.law_picture import law_figure  # imports matplotlib, which takes long

    law = load_law(path or PAPER_LAW)
    # the folder of a design's results has the design's name
    own = "paper-law" if path is None else path.stem if path.stem.endswith("law") else f"{path.stem}-law"
    directory = output or (path or Path("paper.npz")).with_name(own)
    check_writable(directory)
    with staged_result(directory) as folder:
        law_figure(law).savefig(folder / "law.png", dpi=100)
        text = json.dumps(law_record(law).to_json(), indent=1, allow_nan=False) + "\n"
        (folder / "summary.json").write_text(text, encoding="utf-8")
    return [*law_lines(law), f"{directory}: law.png, summary.json"]
