"""Laws of motifs over thickness and width, at cells that their fit has not seen.

python -m benchmarks.motif_laws FOLDER
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.campaign.fit_motif_law import fit_motif_law
from asterism.homogenize.campaign.motif_campaign import run_motif_campaign
from asterism.homogenize.campaign.motif_design_plan import plan_for_motif
from asterism.homogenize.law.motif_errors import MOTIF_QUANTITIES
from asterism.pattern.design.design import Design
from benchmarks.motif_shells import EDGE_MM, MOTIFS
from benchmarks.report import markdown, write_report

# mm
THICKNESSES, WIDTHS, SIDE = (0.3, 0.6), (0.8, 1.6), 60.0
HELD_OUT = 16
TIMED_POINTS = 10_000


def main() -> None:
    folder = Path(sys.argv[1])
    rows = [law_row(name, folder) for name in MOTIFS]
    header = ["motif", "cells", "without a law", "left out", *(f"{name} %" for name in MOTIF_QUANTITIES), "us a point"]
    lines = [
        [
            row["motif"],
            str(row["cells"]),
            str(row["without_law"]),
            str(row["held_out"]),
            *(f"{row[name]['median_percent']:.2f} / {row[name]['largest_percent']:.2f}" for name in MOTIF_QUANTITIES),
            f"{row['microseconds']:.1f}",
        ]
        for row in rows
    ]
    low, high = (f"{a:g} to {b:g} mm" for a, b in (THICKNESSES, WIDTHS))
    text = (
        f"Laws of four motifs, thickness {low}, width {high}, edges of {EDGE_MM:g} mm. Errors at random cells within\n"
    )
    text += (
        "the range of the law that its fit has not seen, in percent, median / largest: of lengths on the flat sheet,\n"
    )
    text += "of the largest energy of a strain, of a curvature, and of the norm of the rest curvature:\n\n"
    text += markdown(header, lines)
    write_report("motif_laws", rows, text)
    print(text)


def law_row(name: str, folder: Path) -> dict[str, Any]:
    """The law of a motif: its cells, its errors, and the time of a value with its derivatives."""
    design = varied(name)
    plan = replace(plan_for_motif(design), held_out=HELD_OUT)
    law = fit_motif_law(plan, run_motif_campaign(plan, folder / name))
    fitted = [each for each in law.samples if not each["held_out"]]
    points = np.random.default_rng(0).uniform(-0.5 * SIDE, 0.5 * SIDE, size=(TIMED_POINTS, 2))
    start = time.process_time()
    law.evaluate_at(design, points)
    microseconds = 1e6 * (time.process_time() - start) / TIMED_POINTS
    held_out = law.residuals["held_out"]
    without = [
        dict(zip(("thickness_mm", "width_mm"), each["sizes"], strict=True)) for each in fitted if each["problem"]
    ]
    row = {
        "motif": name, "cells": len(fitted), "without_law": len(without), "sizes_without_law": without,
        "held_out": held_out["count"], **held_out["errors"], "microseconds": microseconds,
    }  # fmt: skip
    print(row, flush=True)
    return row


def varied(name: str) -> Design:
    """A sheet of a motif whose thickness varies along x, and whose width varies along y."""
    lines, lattice = MOTIFS[name]
    half = 0.5 * SIDE
    across, up = ((-half, 0.0), (half, 0.0)), ((0.0, -half), (0.0, half))

    def field(values: tuple[float, float], ends: tuple[tuple[float, float], tuple[float, float]]) -> dict[str, Any]:
        return {"profile": "linear", "from": values[0], "to": values[1], "start_mm": ends[0], "end_mm": ends[1]}

    rods = {"motif": lines, "thickness_mm": field(THICKNESSES, across), "width_mm": field(WIDTHS, up)}
    border, mesh = {"rectangle_mm": (SIDE, SIDE)}, {"edge_mm": EDGE_MM}
    return Design.from_dict({"name": name, "rods": rods, "lattice": lattice, "border": border, "mesh": mesh})


if __name__ == "__main__":
    main()
