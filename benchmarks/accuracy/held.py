"""Sheets on few supports, compared as these hold them: canopies on corner needles, and other outlines and supports.

python -m benchmarks.accuracy.held FOLDER [--kept] [NAME ...]

FOLDER keeps exact shapes and finished comparisons, as in the study (`benchmarks.accuracy`). No number of the preview
was fitted to these designs. With `--kept`, designs without a finished comparison in FOLDER are left out.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.law.law_file import load_law
from benchmarks.accuracy.__main__ import kept
from benchmarks.accuracy.finished import row_path
from benchmarks.accuracy.held_designs import CANOPY_THICKNESSES_MM, OTHERS, canopies, other_held
from benchmarks.laws import law_of
from benchmarks.report import markdown, write_report

HEIGHT_STEP = 1.05  # ratio of two heights from which their order counts
HEADER = [
    "design", "stars", "rms %", "rms mm", "after a rigid motion %", "expected %", "height exact mm", "height mm",
    "height %", "expected height %", "same form", "exact, two meshes %", "exact shape", "warnings",
]  # fmt: skip

TOTALS = [
    "", "designs", "rms, median %", "nine in ten %", "largest %", "after a rigid motion, median %",
    "rms within expected", "within twice that", "height, median %", "height within expected", "same form",
]  # fmt: skip

Row = dict[str, Any]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.held")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kept", action="store_true")
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    law, rows = load_law(), []
    for design in [*canopies(), *other_held(OTHERS)]:
        is_there = row_path(options.folder, design, starts=False).exists()
        if (options.names and design.name not in options.names) or (options.kept and not is_there):
            continue
        rows.append(kept(design, options.folder, law_of(design, law), starts=False, as_is=options.kept))
        print("  ".join(line(rows[-1])), flush=True)
    text = section(rows)
    print(text)
    if not options.names:
        write_report("accuracy.held", rows, text)


def section(rows: Sequence[Row]) -> str:
    """Markdown."""
    tents = [row for row in rows if row["name"].startswith("canopy")]
    groups = {"all": rows, "canopies": tents, "other outlines and supports": [row for row in rows if row not in tents]}
    table = markdown(TOTALS, [[name, *totals(group)] for name, group in groups.items() if group])
    right, pairs = pairs_in_order(
        [row for row in tents if row["name"].endswith(f"-h{thickness:g}")] for thickness in CANOPY_THICKNESSES_MM
    )
    order = (
        f"Neighbouring scales of the canopies whose exact heights differ by more than 5 %: {right} of {pairs} pairs "
        "are in the order of the exact heights."
    )
    return "\n\n".join([table, order, markdown(HEADER, [line(row) for row in rows])])


def line(row: Row) -> list[str]:
    """One design of the table."""
    exact, preview = row["heights_mm"]
    return [
        row["name"],
        str(row["stars"]),
        f"{row['rms_percent']:.2f}",
        f"{row['rms_mm']:.2f}",
        f"{row['rms_after_motion_percent']:.2f}",
        _number(row["expected_rms_percent"]),
        f"{exact:.1f}",
        f"{preview:.1f}",
        f"{row['height_error_percent']:+.1f}",
        _number(row["expected_height_percent"]),
        "yes" if row["same_branch"] else "no",
        _number(row["mesh_change_percent"]),
        row["result_from"],
        str(len(row["warnings"])),
    ]


def totals(rows: Sequence[Row]) -> list[str]:
    """The columns of `TOTALS` after the first."""
    rms = np.array([row["rms_percent"] for row in rows])
    height = np.abs([row["height_error_percent"] for row in rows])
    return [
        str(len(rows)),
        f"{np.median(rms):.2f}",
        f"{np.quantile(rms, 0.9):.2f}",
        f"{rms.max():.2f}",
        f"{np.median([row['rms_after_motion_percent'] for row in rows]):.2f}",
        _covered(rms, rows, "expected_rms_percent", 1.0),
        _covered(rms, rows, "expected_rms_percent", 2.0),
        f"{np.median(height):.1f}",
        _covered(height, rows, "expected_height_percent", 1.0),
        f"{sum(bool(row['same_branch']) for row in rows)} of {len(rows)}",
    ]


def _covered(errors: np.ndarray, rows: Sequence[Row], key: str, times: float) -> str:
    pairs = [(error, row[key]) for error, row in zip(errors, rows, strict=True) if row[key] is not None]
    return f"{sum(bool(error <= times * expected) for error, expected in pairs)} of {len(pairs)}"


def pairs_in_order(families: Iterable[Sequence[Row]]) -> tuple[int, int]:
    """Pairs of neighbours in families of designs, and how many of these the preview puts in the right order."""
    right = pairs = 0
    for family in families:
        for (first, shown_first), (second, shown_second) in pairwise(row["heights_mm"] for row in family):
            if max(first, second) > HEIGHT_STEP * min(first, second):
                pairs += 1
                right += int((first > second) == (shown_first > shown_second))
    return right, pairs


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


if __name__ == "__main__":
    main()
