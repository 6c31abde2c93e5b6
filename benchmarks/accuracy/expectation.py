"""How good the preview's own expectation is, kind of sheet by kind.

python -m benchmarks.accuracy.expectation FOLDER [--kept]

The constants of the estimate are fitted by `benchmarks.accuracy.error_model`, to these designs and those of
`benchmarks.accuracy.held`. Here the estimate is compared with what is measured, kind by kind: the study and 24 further
designs, small even sheets, ribbons, other outlines and pins, and designs that were drawn later.
FOLDER is that of the study, which comes first; --kept as there: designs without a finished comparison are left out, and
the text names them. As in the study, the exact model starts from the released sheet and from the preview, and the lower
minimum counts. Supported sheets are compared as held.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.previews.run import preview
from benchmarks.accuracy import expected_heights
from benchmarks.accuracy.__main__ import kept
from benchmarks.accuracy.designs import RANDOM, designs, drawn, even, ribbons
from benchmarks.accuracy.exact import exact, lowest
from benchmarks.accuracy.finished import read_row, row_path
from benchmarks.accuracy.report import HEADER, announced, missed, row
from benchmarks.accuracy.unlike import unlike
from benchmarks.report import markdown, write_report

OTHERS = 40  # designs of other outlines and pins
FITTED, UNSEEN = 24, 12  # designs with the seeds that follow the study's, and with those that follow them
LATER, LAST = range(600, 640), range(640, 690)  # seeds
# columns of the study's table
NAMES = [
    "design", "stars", "held", "rms %", "expected %", "same form", "height %", "expected height %", "warnings",
]  # fmt: skip

STUDY, SMALL = "the study and 24 more", "small free sheets of equal stars"
NARROW = "ribbons"
FORTY, FIFTY = "forty more", "fifty drawn after that"
OTHERWISE = "other outlines and pins"
AFTERWARDS = "designs drawn afterwards"
HEIGHTS = (STUDY, SMALL, AFTERWARDS, OTHERWISE, FORTY, FIFTY)

Row = dict[str, Any]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.expectation")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kept", action="store_true")
    options = parser.parse_args()
    law, left_out = load_law(), list[str]()

    def rows(chosen: Sequence[Design]) -> list[Row]:
        return _rows(chosen, options.folder, law, options.kept, left_out)

    more = [drawn(seed) for seed in range(RANDOM, RANDOM + FITTED + UNSEEN)]
    known, small, unseen = rows([*designs(), *more[:FITTED]]), rows(even()), rows(more[FITTED:])
    narrow, others = rows(ribbons()), rows(unlike(OTHERS))
    later, last = (rows([drawn(seed) for seed in seeds]) for seeds in (LATER, LAST))
    text = section(known, small, unseen, narrow, others, later, last)
    if left_out:
        text += f"\n\nNot compared as held yet, and left out: {', '.join(left_out)}."
    print(text)
    write_report("accuracy.expectation", [*known, *small, *unseen, *narrow, *others, *later, *last], text)


def _rows(chosen: Sequence[Design], folder: Path, law: Law, as_is: bool, left_out: list[str]) -> list[Row]:
    """Those that have a law and an exact minimum; names of designs that have no comparison yet go to `left_out`."""
    rows = []
    for design in chosen:
        try:
            law.check(design)
        except LawError:
            continue
        if as_is and read_row(row_path(folder, design, starts=False), design) is None:
            left_out.append(design.name)
            continue
        if not as_is:
            exact(design, folder, near=lambda design=design: preview(design, law))  # type: ignore[misc]
            if not lowest(design, folder).summary["is_minimum"]:
                print(f"{design.name}: the exact model has found no certain shape", flush=True)
                continue
        rows.append(kept(design, folder, law, starts=False, as_is=as_is))
        print("  ".join(row(rows[-1])), flush=True)
    return rows


def section(
    study: Sequence[Row],
    small: Sequence[Row],
    unseen: Sequence[Row],
    narrow: Sequence[Row],
    others: Sequence[Row],
    later: Sequence[Row],
    last: Sequence[Row],
) -> str:
    """Markdown."""
    groups = {
        STUDY: study,
        SMALL: small,
        AFTERWARDS: unseen,
        NARROW: narrow,
        OTHERWISE: others,
        FORTY: later,
        FIFTY: last,
    }
    lines = [[name, *_goodness(rows)] for name, rows in groups.items() if rows]
    header = [
        "", "designs", "supported", "rms, median %", "nine in ten %", "distance over expected, median", "nine in ten",
        "misses", "of these announced", "announced in all",
    ]  # fmt: skip
    tables = [
        [[cells[HEADER.index(name)] for name in NAMES] for cells in map(row, rows)]
        for rows in (small, unseen, narrow, others, list(filter(missed, [*later, *last])))
    ]
    return "\n\n".join(
        [
            markdown(header, lines),
            "Heights:",
            expected_heights.section({name: groups[name] for name in HEIGHTS}),
            "Small free sheets of equal stars (lengths l and thicknesses h in mm):",
            markdown(NAMES, tables[0]),
            "The designs drawn afterwards:",
            markdown(NAMES, tables[1]),
            "Ribbons, one to four rows of stars:",
            markdown(NAMES, tables[2]),
            "Other outlines and pins (`benchmarks/accuracy/unlike.py`):",
            markdown(NAMES, tables[3]),
            "Of those drawn last and compared, those that miss:",
            markdown(NAMES, tables[4]),
        ]
    )


def _goodness(rows: Sequence[Row]) -> list[str]:
    ratio = [
        entry["rms_percent"] / entry["expected_rms_percent"]
        for entry in rows
        if entry["expected_rms_percent"] is not None
    ]
    far, rms = [entry for entry in rows if missed(entry)], [entry["rms_percent"] for entry in rows]
    return [
        str(len(rows)),
        str(sum(bool(entry["design"].get("pins")) for entry in rows)),
        f"{np.median(rms):.2f}",
        f"{np.quantile(rms, 0.9):.2f}",
        f"{np.median(ratio):.2f}",
        f"{np.quantile(ratio, 0.9):.2f}",
        str(len(far)),
        str(sum(map(announced, far))),
        str(sum(map(announced, rows))),
    ]


if __name__ == "__main__":
    main()
