"""What each part of the preview model gains: previews with all parts, and with one part turned off.

python -m benchmarks.ablation [DESIGN ...] [--frozen] [--part PART ...] [--keep FOLDER] [--edge MM] [--write]

DESIGN is a name of the gallery, random-NN, a sheet on few supports (`benchmarks.accuracy.held_designs`), to which
nothing was fitted, or a frozen design of the first two sets (`benchmarks.frozen`); by default the gallery and the 24
random designs of the study. --frozen takes both sets: those that FOLDER has both exact shapes of, which
`benchmarks.frozen.solve` computes. With --part only these parts are turned off, each alone. Each preview is compared
with the lower of two exact shapes: that of the released sheet, and that found from the preview with all parts. FOLDER
keeps the exact shapes; without it they are computed again. Distances are rms as held, in % of the diameter
(`asterism.shape.comparison`). A gain is the distance without the part less the distance with it; a part changes the
form of a design if it has the exact shape's form with all parts and not without it, or the other way round. The mean
gain stands beside its standard error over the designs: a part whose mean gain is within two of these has no effect
that these designs show. Parts that change only bumps show in heights and bumps (the relief of the surface over its
cell means, in % of its own size). FOLDER keeps the distances too, as long as the code of the preview stays the same.
Parts and the values that turn them off: `asterism.previews.model_parts`. --write puts the table into
benchmarks/results.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.model import PreviewModel
from asterism.previews.model_parts import PARTS, without
from asterism.previews.run import preview
from asterism.previews.serving_law import serving_law
from asterism.results.files import write_file
from asterism.shape.cell_mean import CellMean
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from asterism.verification.numbers import same_branch
from benchmarks.accuracy.__main__ import preview_code
from benchmarks.accuracy.designs import EDGE_MM, RANDOM, drawn, meshed
from benchmarks.accuracy.exact import exact, lowest
from benchmarks.accuracy.held_designs import OTHERS, canopies, other_held
from benchmarks.frozen.draw import CHOSEN_ON, frozen
from benchmarks.frozen.solve import frozen_law, is_solved
from benchmarks.report import markdown, write_report

RANDOM_PREFIX = "random-"
HELD_PREFIXES = ("canopy-", "held-")
FROZEN_PREFIXES = ("frozen-", "second-")
COMMAND = "python -m benchmarks.ablation"
ROWS = "ablation"  # name of the report, and of the file of each design in the folder
MIN_CHANGE_PERCENT = 0.005  # of the diameter: smaller changes of the distance are no change
HEADER = [
    "part turned off", "designs that it changes", "median rms %, with", "without", "mean rms %, with", "without",
    "mean gain %", "its standard error %", "largest gain %", "largest loss %", "form changes",
    "median error of the height %, with", "without", "median error of the bumps %, with", "without",
]  # fmt: skip


def main(words: Sequence[str]) -> int:
    """Print a line for each design, then the table; exit status 1 if no design could be compared."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("designs", nargs="*", metavar="DESIGN")
    parser.add_argument("--frozen", action="store_true")
    parser.add_argument("--part", action="append", choices=PARTS, metavar="PART")
    parser.add_argument("--keep", type=Path, default=None, metavar="FOLDER")
    parser.add_argument("--edge", type=float, default=EDGE_MM, metavar="MM")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args(words)
    parts = options.part or list(PARTS)
    names = options.designs or [*gallery.names(), *(f"{RANDOM_PREFIX}{seed:02d}" for seed in range(RANDOM))]
    if options.frozen:
        if options.keep is None:
            parser.error("--frozen: needs --keep FOLDER, the folder of python -m benchmarks.frozen.solve")
        names = [design.name for design in _frozen_designs() if is_solved(design, options.keep)]
    with tempfile.TemporaryDirectory() as folder:
        rows = []
        for name in names:
            try:
                rows.append(_kept_row(named(name, options.edge), options.keep or Path(folder), parts))
            except LawError as error:
                print(f"{name}: no preview: {error}", flush=True)
                continue
            print(_line(rows[-1]), flush=True)
    if not rows:
        return 1
    text = f"{len(rows)} designs: {', '.join(row['design'] for row in rows)}.\n\n{table(rows)}"
    print(text)
    if options.write:
        name, command = (f"{ROWS}.frozen", f"{COMMAND} --frozen --keep FOLDER") if options.frozen else (ROWS, COMMAND)
        write_report(name, rows, text, command=f"{command} --write")
    return 0


def named(name: str, edge_mm: float = EDGE_MM) -> Design:
    """A design of the gallery, a random one or one on few supports, with this edge of its mesh in mm."""
    if name.startswith(RANDOM_PREFIX):
        return drawn(int(name.removeprefix(RANDOM_PREFIX)), edge_mm)
    if name.startswith(HELD_PREFIXES):
        return next(each for each in [*canopies(edge_mm), *other_held(OTHERS, edge_mm)] if each.name == name)
    if name.startswith(FROZEN_PREFIXES):
        return next(design for design in _frozen_designs() if design.name == name)
    return meshed(gallery.load(name), edge_mm)


def _frozen_designs() -> list[Design]:
    return [design for group in CHOSEN_ON for _, design in frozen(group)]


def ablated(design: Design, folder: Path, parts: Sequence[str] = tuple(PARTS)) -> dict[str, Any]:
    """Distance and form of a design's previews: with all parts, and by the part that is turned off."""
    plan = layout(design)
    is_frozen = design.name.startswith(FROZEN_PREFIXES)
    law = frozen_law(design, folder) if is_frozen else serving_law(design, plan)
    shown = preview(design, law, plan=plan)
    exact(design, folder, near=lambda: shown)
    reference = lowest(design, folder)
    mean = CellMean(reference.printed, reference.weights, plan.lattice_vectors)
    return {
        "design": design.name,
        "all": _distance(reference, mean, shown, design, plan),
        "without": {part: _ablated_distance(reference, mean, design, plan, law, without(part)) for part in parts},
    }


def _kept_row(design: Design, folder: Path, parts: Sequence[str]) -> dict[str, Any]:
    """The row of a design, with the numbers of this code that the folder has."""
    path = folder / design.name / f"{ROWS}.json"
    made_by = hashlib.sha256(b"".join(preview_code())).hexdigest()[:16]
    kept: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    if kept.get("made_by") == made_by and set(parts) <= set(kept["without"]):
        return kept | {"without": {part: kept["without"][part] for part in parts}}
    row = ablated(design, folder, parts)
    write_file(path, json.dumps(row | {"made_by": made_by}, indent=1) + "\n")
    return row


def _ablated_distance(
    reference: Shape, mean: CellMean, design: Design, plan: Layout, law: Law, model: PreviewModel
) -> dict[str, Any]:
    """Of the preview with a model; without numbers if its rest metric is not positive definite."""
    try:
        return _distance(reference, mean, preview(design, law, model=model, plan=plan), design, plan)
    except LawError:
        return {"rms_percent": None, "same_form": False, "height_percent": None, "bumps_percent": None}


def _distance(reference: Shape, mean: CellMean, shape: Shape, design: Design, plan: Layout) -> dict[str, Any]:
    """rms distance to the exact shape in % of the diameter, form, and errors of height and bumps in %."""
    comparison = compare_shapes(reference, shape, plan, symmetries(design, plan), design.gravity.pull, mean=mean)
    height, other = comparison.heights_mm
    return {
        "rms_percent": float(comparison.rms_percent),
        "same_form": bool(same_branch(comparison, None)),
        "height_percent": 100.0 * abs(other / height - 1.0),
        "bumps_percent": comparison.relief_error_percent,
    }


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Markdown, one line for each part, the largest mean gain first."""
    lines = [(_gains(rows, part).mean(), part) for part in rows[0]["without"]]
    return markdown(HEADER, [_part_line(rows, part) for _, part in sorted(lines, key=lambda line: -line[0])])


def _known(rows: Sequence[dict[str, Any]], part: str) -> list[dict[str, Any]]:
    """The rows that have a preview without the part."""
    return [row for row in rows if row["without"][part]["rms_percent"] is not None]


def _gains(rows: Sequence[dict[str, Any]], part: str) -> np.ndarray:
    """(n,) % by which the distance grows where the part is turned off; a single 0 without any."""
    gains = [row["without"][part]["rms_percent"] - row["all"]["rms_percent"] for row in _known(rows, part)]
    return np.array(gains or [0.0])


def _part_line(rows: Sequence[dict[str, Any]], part: str) -> list[str]:
    gains = _gains(rows, part)
    on = np.array([row["all"]["rms_percent"] for row in _known(rows, part)] or [np.nan])
    forms = sum(row["without"][part]["same_form"] != row["all"]["same_form"] for row in rows)
    changed = int((np.abs(gains) > MIN_CHANGE_PERCENT).sum())
    numbers = np.median(on), np.median(on + gains), on.mean(), (on + gains).mean()
    error = gains.std(ddof=1) / np.sqrt(len(gains)) if len(gains) > 1 else np.nan
    changes = gains.max(), gains.min()
    known = _known(rows, part)
    medians = [
        float(np.median([one[key] for one in each] or [np.nan]))
        for key in ("height_percent", "bumps_percent")
        for each in ([row["all"] for row in known], [row["without"][part] for row in known])
    ]
    return [
        part, str(changed), *(f"{x:.2f}" for x in numbers), f"{gains.mean() + 0.0:+.3f}", f"{error:.3f}",
        *(f"{x + 0.0:+.2f}" for x in changes), str(forms),
        *(f"{x:.1f}" for x in medians),
    ]  # fmt: skip


def _line(row: dict[str, Any]) -> str:
    """A design's distance, and the part that gains most there."""
    part = max(row["without"], key=lambda part: row["without"][part]["rms_percent"] or 0.0)
    most = row["without"][part]["rms_percent"]
    return f"{row['design']:<28} rms {row['all']['rms_percent']:.2f} %, without {part} {most:.2f} %"


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
