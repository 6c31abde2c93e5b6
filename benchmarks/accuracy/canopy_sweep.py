"""30 canopies on four, five and six needles over scale and thickness: distances as held, and the order of heights.

python -m benchmarks.accuracy.canopy_sweep FOLDER [NAME ...]

FOLDER keeps exact shapes, from the flat print and from the preview, and finished comparisons. No number of the preview
was fitted to these designs; they judge its error model (`benchmarks.accuracy.error_model`).
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import Any

from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.previews.run import preview
from benchmarks.accuracy.__main__ import kept
from benchmarks.accuracy.designs import EDGE_MM
from benchmarks.accuracy.exact import exact
from benchmarks.accuracy.held import HEADER, TOTALS, line, pairs_in_order, totals
from benchmarks.accuracy.held_designs import CANOPY_THICKNESSES_MM
from benchmarks.report import markdown, write_report

SCALES = (0.6, 0.675, 0.75, 0.825, 0.9)
# printed places of the needles, in halves of the sheet's sides
CORNERS = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
NEEDLES = {4: CORNERS, 5: (*CORNERS, (0.0, -1.0)), 6: (*CORNERS, (0.0, -1.0), (0.0, 1.0))}
# smaller than the other canopies, with shorter arms
SIDES_MM = (140.0, 100.0)
ARM_MM = 7.0


def swept() -> list[Design]:
    """The canopies; those that follow each other differ in scale."""
    half_x, half_y = 0.5 * SIDES_MM[0], 0.5 * SIDES_MM[1]
    return [
        Design.from_dict(
            {
                "name": f"canopy-n{count}-h{thickness:g}-s{scale:g}",
                "stars": {"length_mm": ARM_MM, "thickness_mm": thickness},
                "border": {"rectangle_mm": SIDES_MM},
                "pins": [{"points_mm": [(half_x * x, half_y * y) for x, y in places], "scale": scale}],
                "mesh": {"edge_mm": EDGE_MM},
            }
        )
        for count, places in NEEDLES.items()
        for thickness in CANOPY_THICKNESSES_MM
        for scale in SCALES
    ]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.canopy_sweep")
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    law, rows = load_law(), []
    for design in swept():
        if options.names and design.name not in options.names:
            continue
        exact(design, options.folder)
        exact(design, options.folder, near=lambda design=design: preview(design, law))
        rows.append(kept(design, options.folder, law, starts=False, as_is=False))
        print("  ".join(line(rows[-1])), flush=True)
    text = section(rows)
    print(text)
    if not options.names:
        write_report("accuracy.canopy_sweep", rows, text)


def section(rows: Sequence[dict[str, Any]]) -> str:
    """Markdown."""
    families = [list(family) for _, family in groupby(rows, key=lambda row: row["name"].rpartition("-s")[0])]
    groups = {"all": rows}
    for count in NEEDLES:
        groups[f"{count} needles"] = [row for row in rows if row["name"].startswith(f"canopy-n{count}-")]
    table = markdown(TOTALS, [[name, *totals(group)] for name, group in groups.items() if group])
    right, pairs = pairs_in_order(families)
    order = (
        f"Neighbouring scales whose exact heights differ by more than 5 %: {right} of {pairs} pairs are in the order "
        "of the exact heights."
    )
    return "\n\n".join([table, order, markdown(HEADER, [line(row) for row in rows])])


if __name__ == "__main__":
    main()
