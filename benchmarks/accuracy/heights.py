"""Where the heights of held sheets are lost: above what holds them, or below.

python -m benchmarks.accuracy.heights FOLDER [NAME ...]

A sheet's height is from its lowest to its highest point, stars' bumps and all. Of every held design of the study, and
of 24 more, this says how far both models reach above and below the place where they are held, and how far the exact
sheet's lowest point is from the tip of an arm. FOLDER is that of the study.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from benchmarks.accuracy.designs import RANDOM, designs, drawn
from benchmarks.accuracy.exact import lowest
from benchmarks.report import markdown, write_report

NAMES = ["design", "held by", "exact, mm", "preview, mm", "height %", "rise %", "lowest point to a tip, mm"]
MORE = 24  # designs with the seeds that follow the study's


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.heights")
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    law, rows = load_law(), []
    for design in [*designs(), *(drawn(seed) for seed in range(RANDOM, RANDOM + MORE))]:
        if not design.pins or (options.names and design.name not in options.names):
            continue
        try:
            law.check(design)
        except LawError:
            continue
        rows.append(heights(design, options.folder, law))
        print("  ".join(line(rows[-1])), flush=True)
    text = "\n\n".join([markdown(NAMES, [line(row) for row in rows]), *map(middle, _groups(rows))])
    print(text)
    if not options.names:
        write_report("accuracy.heights", rows, text)


def heights(design: Design, folder: Path, law: Law) -> dict[str, Any]:
    """What both sheets reach, in mm from the ground, and the errors of the preview in %."""
    plan = layout(design)
    exact = lowest(design, folder)
    comparison = compare_shapes(exact, preview(design, law), plan, symmetries(design, plan), design.gravity.pull)
    rises = comparison.rises_mm
    right, shown = exact.positions[:, 2], comparison.other.positions[:, 2]
    tips = exact.printed[[path[-1] for path in exact.rods]]
    return {
        "name": design.name,
        "held_by": "points" if any(len(pin.points) for pin in plan.pins) else "edges",
        "exact_mm": [float(right.min()), float(right.max())],
        "preview_mm": [float(shown.min()), float(shown.max())],
        "height_error_percent": 100.0 * float(np.ptp(shown) / np.ptp(right) - 1.0),
        "rise_error_percent": 100.0 * (rises[1] / rises[0] - 1.0) if rises else None,
        "to_a_tip_mm": float(np.linalg.norm(tips - exact.printed[right.argmin()], axis=1).min()),
    }


def line(row: dict[str, Any]) -> list[str]:
    reach = [f"{low:.1f} to {high:.1f}" for low, high in (row["exact_mm"], row["preview_mm"])]
    errors = ["-" if row[key] is None else f"{row[key]:+.1f}" for key in ("height_error_percent", "rise_error_percent")]
    return [row["name"], row["held_by"], *reach, *errors, f"{row['to_a_tip_mm']:.1f}"]


def _groups(rows: list[dict[str, Any]]) -> list[list[dict[str, Any]]]:
    both = [[row for row in rows if row["held_by"] == kind] for kind in ("points", "edges")]
    return [group for group in both if group]


def middle(rows: list[dict[str, Any]]) -> str:
    """One sentence on a group of rows."""
    height, rise = (
        np.abs([row[key] for row in rows if row[key] is not None])
        for key in ("height_error_percent", "rise_error_percent")
    )
    return (
        f"{len(rows)} designs held by {rows[0]['held_by']}: height {np.median(height):.1f} % off in the middle, "
        f"{(height <= 6.0).sum()} within 6 %; rise {np.median(rise):.1f} % off, {(rise <= 6.0).sum()} within 6 %."
    )


if __name__ == "__main__":
    main()
