"""What a law of edges could gain: previews of ribbons with the curl of their rims chosen for each ribbon by itself.

python -m benchmarks.accuracy.ribbon_rims FOLDER FROZEN_FOLDER

A cell of a ribbon would give the rest curvature of its rim from the stars beside it, in place of one factor for all
sheets. No such law can come nearer, by that curvature, than the factor that is best for each ribbon. FOLDER is that of
the study, and FROZEN_FOLDER that of `benchmarks.frozen.solve`; ribbons without exact shapes there are left out.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from benchmarks.accuracy.designs import ribbons
from benchmarks.accuracy.exact import lowest
from benchmarks.frozen.draw import WORKING, frozen
from benchmarks.frozen.solve import is_solved
from benchmarks.report import markdown, write_report
from homogenize.law.law_file import load_law
from pattern.design.design import Design
from pattern.layout.print_layout import print_layout
from pattern.layout.symmetries import symmetries

FACTORS = (0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0)

Row = dict[str, Any]


def solved_ribbons(folder: Path, frozen_folder: Path) -> list[tuple[Design, Path]]:
    """Ribbons with an exact shape, and the folders that hold them."""
    known = [(design, folder) for design in ribbons() if (folder / design.name / "released" / "summary.json").exists()]
    drawn = [design for kind, design in frozen(WORKING) if kind == "ribbon" and is_solved(design, frozen_folder)]
    return [*known, *((design, frozen_folder) for design in drawn)]


def measured(design: Design, folder: Path) -> Row:
    """Distances of the previews with each factor, and without arms into the rim."""
    law, layout = load_law(), print_layout(design)
    exact, same = lowest(design, folder), symmetries(design, layout)

    def distance(**changed: Any) -> float:
        shape = preview(design, law, model=replace(PREVIEW_MODEL, **changed))
        return float(compare_shapes(exact, shape, layout, same, design.gravity.pull).rms_percent)

    by_factor = {factor: distance(rim_curl_factor=factor) for factor in FACTORS}
    return {"design": design.name, "by_factor": by_factor, "without_arms": distance(has_rim_arms=False)}


def section(rows: Sequence[Row]) -> str:
    """Markdown."""
    present = PREVIEW_MODEL.rim_curl_factor
    lines = []
    for row in rows:
        best = min(row["by_factor"], key=row["by_factor"].__getitem__)
        distances = [f"{row['by_factor'][factor]:.2f}" for factor in FACTORS]
        lines.append([row["design"], *distances, f"{best:g}", f"{row['without_arms']:.2f}"])
    table = markdown(["rms %, factor", *(f"{factor:g}" for factor in FACTORS), "best", "no arms"], lines)
    now, least = (
        np.array([of(row["by_factor"]) for row in rows]) for of in (lambda d: d[present], lambda d: min(d.values()))
    )
    text = (
        f"Median with the factor {present:g} of the preview: {np.median(now):.2f} %, nine in ten "
        f"{np.quantile(now, 0.9):.2f} %; with the best factor of each ribbon: {np.median(least):.2f} %, "
        f"{np.quantile(least, 0.9):.2f} %."
    )
    return f"{table}\n\n{text}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.ribbon_rims")
    parser.add_argument("folder", type=Path)
    parser.add_argument("frozen_folder", type=Path)
    options = parser.parse_args()
    rows = []
    for design, folder in solved_ribbons(options.folder, options.frozen_folder):
        rows.append(measured(design, folder))
        print(rows[-1], flush=True)
    text = section(rows)
    print(text)
    write_report(
        "accuracy.ribbon_rims", rows, text, command="python -m benchmarks.accuracy.ribbon_rims FOLDER FROZEN_FOLDER"
    )


if __name__ == "__main__":
    main()
