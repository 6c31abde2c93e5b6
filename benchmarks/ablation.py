"""What each part of the preview model gains: previews with all parts, and with one part turned off.

python -m benchmarks.ablation FOLDER [DESIGN ...] [--frozen] [--part PART ...] [--edge MM] [--write]

DESIGN is a name of the gallery, random-NN, a sheet on few supports (`benchmarks.accuracy.designs`), or a frozen design
of the first two sets; by default the gallery and the 24 random designs of the study. --frozen takes both sets: those
that FOLDER has both exact shapes of, which `benchmarks.frozen.solve` computes. Each preview is compared with the lower
of two exact shapes, from the released sheet and from the preview with all parts; FOLDER keeps them. Distances are rms
as held, in % of the diameter. A gain is the distance without the part less the distance with it; its mean stands beside
its standard error over the designs: a part whose mean gain is within two of these has no effect that these designs
show. A part changes the form of a design if the design has the form of the exact shape only with it, or only without.
Parts that change only bumps show in heights and bumps. Parts and the values that turn them off:
`asterism.previews.model`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.pattern.design.design import Design
from asterism.previews.model import PARTS, without
from asterism.previews.run import preview
from asterism.shape.comparison import Comparison
from asterism.verification.numbers import same_branch
from benchmarks.accuracy.comparisons import Reference, Row, exact, is_solved, law_for
from benchmarks.accuracy.designs import EDGE_MM, canopies, designs, other_held
from benchmarks.frozen.draw import CHOSEN_ON, frozen
from benchmarks.report import chosen, markdown, write_report

MIN_CHANGE_PERCENT = 0.005  # of the diameter: smaller changes of the distance are no change
MEAN_GAIN = "mean gain %"
HEADER = [
    "part turned off", "designs that it changes", "median rms %, with", "without", MEAN_GAIN, "its standard error %",
    "largest gain %", "largest loss %", "form changes", "median error of the height %, with", "without",
    "median error of the bumps %, with", "without",
]  # fmt: skip


def main() -> int:
    """Print a line for each design, then the table; exit status 1 if no design could be compared."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ablation")
    parser.add_argument("folder", type=Path)
    parser.add_argument("designs", nargs="*", metavar="DESIGN")
    parser.add_argument("--frozen", action="store_true")
    parser.add_argument("--part", action="append", choices=PARTS, metavar="PART")
    parser.add_argument("--edge", type=float, default=EDGE_MM, metavar="MM")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_intermixed_args()
    drawn = [design for group in CHOSEN_ON for _, design in frozen(group)]
    study = designs(options.edge)
    known = {each.name: each for each in [*study, *canopies(options.edge), *other_held(options.edge), *drawn]}
    names = options.designs or [design.name for design in study]
    if options.frozen:
        names = [design.name for design in drawn if is_solved(design, options.folder)]
        if not names:
            parser.error(f"FOLDER: {options.folder} has no exact shapes: run python -m benchmarks.frozen.solve first")
    rows = []
    for design in chosen(parser, names, known):
        try:
            rows.append(ablated(design, options.folder, options.part or list(PARTS)))
        except LawError as error:
            print(f"{design.name}: no preview: {error}", flush=True)
            continue
        print(f"{design.name}: rms {rows[-1]['all']['rms']:.2f} %", flush=True)
    if not rows:
        return 1
    text = f"{len(rows)} designs: {', '.join(row['design'] for row in rows)}.\n\n{table(rows)}"
    print(text)
    if options.write:
        flag = " --frozen" if options.frozen else ""
        write_report("ablation", text, f"python -m benchmarks.ablation FOLDER{flag} --write")
    return 0


def ablated(design: Design, folder: Path, parts: Sequence[str]) -> Row:
    """Distance and form of a design's previews: with all parts, and by the part that is turned off."""
    exact(design, folder, near=lambda: preview(design, law_for(design, folder)))
    reference = Reference(design, folder)
    whole = reference.compared()
    if whole is None:
        raise LawError(f"{design.name}: the law refuses the sheet")
    return {
        "design": design.name,
        "all": _distance(whole),
        "without": {part: _distance(reference.compared(without(part))) for part in parts},
    }


def _distance(comparison: Comparison | None) -> dict[str, Any]:
    """rms distance in % of the diameter, form, and errors of height and bumps in %; without numbers if refused."""
    if comparison is None:
        return {"rms": None, "form": False, "height": None, "bumps": None}
    height, other = comparison.heights_mm
    return {
        "rms": float(comparison.rms_percent),
        "form": bool(same_branch(comparison, None)),
        "height": 100.0 * abs(other / height - 1.0),
        "bumps": comparison.relief_error_percent,
    }


def table(rows: Sequence[Row]) -> str:
    """Markdown, one line for each part, the largest mean gain first."""
    lines = [_part_line(rows, part) for part in rows[0]["without"]]
    return markdown(HEADER, sorted(lines, key=lambda line: -float(line[HEADER.index(MEAN_GAIN)])))


def _part_line(rows: Sequence[Row], part: str) -> list[str]:
    known = [row for row in rows if row["without"][part]["rms"] is not None]
    on, off = ([each[key] for each in known] for key in ("all", "without"))
    off = [each[part] for each in off]

    def median(some: Sequence[dict[str, Any]], key: str) -> float:
        return float(np.median([one[key] for one in some if one[key] is not None] or [np.nan]))

    gains = np.array([b["rms"] - a["rms"] for a, b in zip(on, off, strict=True)] or [0.0])
    error = gains.std(ddof=1) / np.sqrt(len(gains)) if len(gains) > 1 else np.nan
    forms = sum(row["without"][part]["form"] != row["all"]["form"] for row in rows)
    return [
        part, str(int((np.abs(gains) > MIN_CHANGE_PERCENT).sum())),
        f"{median(on, 'rms'):.2f}", f"{median(off, 'rms'):.2f}", f"{gains.mean() + 0.0:+.3f}", f"{error:.3f}",
        f"{gains.max() + 0.0:+.2f}", f"{gains.min() + 0.0:+.2f}", str(forms),
        *(f"{median(some, key):.1f}" for key in ("height", "bumps") for some in (on, off)),
    ]  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
