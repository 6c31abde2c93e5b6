"""The preview against the exact model on the frozen designs, as their supports hold them.

python -m benchmarks.frozen.compare FOLDER [--half sealed] [--open-second-set | --open-third-set] [NAME ...]

FOLDER is that of `benchmarks.frozen.solve`; it keeps finished comparisons as long as the preview and its code stay the
same. The working half is compared, or with `--half sealed` the half that judged an earlier model and is open since.
`--open-second-set` compares the second set, which judged the model of 26 November 2026, and `--open-third-set` the
third.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.accuracy.__main__ import kept
from benchmarks.accuracy.held import HEADER as DESIGN_HEADER
from benchmarks.accuracy.held import line
from benchmarks.accuracy.report import HEIGHT_FAR, announced, height_announced, height_missed, missed
from benchmarks.frozen.draw import FREE, HALVES, KINDS, LATER, SEALED, SUPPORTED, WORKING, frozen
from benchmarks.frozen.solve import frozen_law, is_solved
from benchmarks.report import markdown, write_report

CLOSE = 1.0  # % of the diameter: of sheets within it few should carry a warning
HEADER = [
    "kind", "designs", "rms, median %", "nine in ten %", "largest %", "after a rigid motion, median %", "same form",
    "height, median %", f"heights within {HEIGHT_FAR:g} %", "others announced", "misses", "announced",
    "rms within expected", f"within {CLOSE:g} %", "of these with a warning", "exact, two meshes, median %",
    "exact, two meshes, nine in ten %", "previews closer than that",
]  # fmt: skip

Row = dict[str, Any]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.frozen.compare")
    parser.add_argument("folder", type=Path)
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--half", choices=HALVES, default=WORKING)
    for each in LATER:
        which.add_argument(f"--open-{each}-set", dest="half", action="store_const", const=each)
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    half = options.half
    rows, without = [], []
    for kind, design in frozen(half):
        if options.names and design.name not in options.names:
            continue
        if not is_solved(design, options.folder):
            without.append(design.name)
            continue
        law = frozen_law(design, options.folder)
        rows.append(kept(design, options.folder, law, starts=False, as_is=False) | {"kind": kind})
        print("  ".join(line(rows[-1])), flush=True)
    text = section(rows, without)
    print(text)
    if not options.names:
        flag = {WORKING: "", SEALED: " --half sealed"}.get(half, f" --open-{half}-set")
        write_report(f"frozen.{half}", rows, text, command=f"python -m benchmarks.frozen.compare FOLDER{flag}")


def section(rows: Sequence[Row], without: Sequence[str]) -> str:
    """Markdown."""
    groups: dict[str, list[Row]] = {
        "all": list(rows),
        "all supported": [row for row in rows if row["design"].get("pins")],
        "all free": [row for row in rows if not row["design"].get("pins")],
    }
    names = {FREE: "free outlines", SUPPORTED: "supported outlines"}
    groups |= {names.get(kind, kind): [row for row in rows if row["kind"] == kind] for kind in KINDS}
    table = markdown(HEADER, [[name, *_totals(group)] for name, group in groups.items() if group])
    unsolved = [f"Without exact shapes: {', '.join(without)}."] if without else []
    return "\n\n".join([table, *unsolved, markdown(DESIGN_HEADER, [line(row) for row in rows])])


def _totals(rows: Sequence[Row]) -> list[str]:
    rms = np.array([row["rms_percent"] for row in rows])
    far, high = [row for row in rows if missed(row)], [row for row in rows if height_missed(row)]
    known = [row for row in rows if row["expected_rms_percent"] is not None]
    close = [row for row in rows if row["rms_percent"] <= CLOSE]
    meshes = [row for row in rows if row["mesh_change_percent"] is not None]
    changes = np.array([row["mesh_change_percent"] for row in meshes])
    return [
        str(len(rows)),
        f"{np.median(rms):.2f}",
        f"{np.quantile(rms, 0.9):.2f}",
        f"{rms.max():.2f}",
        f"{np.median([row['rms_after_motion_percent'] for row in rows]):.2f}",
        f"{sum(bool(row['same_branch']) for row in rows)}",
        f"{np.median(np.abs([row['height_error_percent'] for row in rows])):.1f}",
        f"{len(rows) - len(high)}",
        f"{sum(map(height_announced, high))} of {len(high)}",
        f"{len(far)}",
        f"{sum(map(announced, far))}",
        f"{sum(row['rms_percent'] <= row['expected_rms_percent'] for row in known)} of {len(known)}",
        f"{len(close)}",
        f"{sum(bool(row['warnings']) for row in close)}",
        f"{np.median(changes):.2f}",
        f"{np.quantile(changes, 0.9):.2f}",
        f"{sum(row['rms_percent'] < row['mesh_change_percent'] for row in meshes)} of {len(meshes)}",
    ]


if __name__ == "__main__":
    main()
