"""Sheets on few supports, compared as these hold them: canopies on corner needles, and other outlines and supports.

python -m benchmarks.accuracy.held FOLDER [NAME ...]    (with names: these only, no report)

FOLDER keeps exact shapes and finished comparisons, as in the study (`benchmarks.accuracy`). No constant of the shape
was fitted to these designs.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

from benchmarks.accuracy.comparisons import Row, compared
from benchmarks.accuracy.designs import CANOPY_THICKNESSES_MM, canopies, other_held
from benchmarks.accuracy.tables import line, section
from benchmarks.report import chosen, write_report

HEIGHT_STEP = 1.05  # ratio of two heights from which their order counts


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.held")
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    options = parser.parse_intermixed_args()
    rows = []
    for design in chosen(parser, options.names, {design.name: design for design in [*canopies(), *other_held()]}):
        rows.append(compared(design, options.folder))
        print("  ".join(line(rows[-1])), flush=True)
    if not options.names:
        text = table(rows)
        print(text)
        write_report("accuracy.held", text, "python -m benchmarks.accuracy.held FOLDER")


def table(rows: Sequence[Row]) -> str:
    """Markdown."""
    tents = [row for row in rows if row["name"].startswith("canopy")]
    groups = {"all": rows, "canopies": tents, "other outlines and supports": [row for row in rows if row not in tents]}
    pairs = [
        (one, other)
        for thickness in CANOPY_THICKNESSES_MM
        for one, other in pairwise(row["heights_mm"] for row in tents if row["name"].endswith(f"-h{thickness:g}"))
        if max(one[0], other[0]) > HEIGHT_STEP * min(one[0], other[0])
    ]
    right = sum((one[0] > other[0]) == (one[1] > other[1]) for one, other in pairs)
    order = (
        f"Neighbouring scales of the canopies whose exact heights differ by more than 5 %: {right} of {len(pairs)} "
        "pairs are in the order of the exact heights."
    )
    return section(groups, order)


if __name__ == "__main__":
    main()
