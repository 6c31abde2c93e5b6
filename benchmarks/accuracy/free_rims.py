"""What the parts of a free rim gain: previews of free sheets with both, and with each and both turned off.

python -m benchmarks.accuracy.free_rims FOLDER FROZEN_FOLDER

The rim turns beyond the tips of the arms (`asterism.previews.edges.free_rim`, no fitted constant), and the arms bend it
(`asterism.previews.edges.rim_arms`, one). FOLDER is that of the study, and FROZEN_FOLDER that of
`benchmarks.frozen.solve`; designs without exact shapes there are left out. Frozen designs are those of the first set.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.model_parts import PARTS
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from benchmarks.accuracy.designs import even, ribbons
from benchmarks.accuracy.exact import lowest
from benchmarks.accuracy.expectation import OTHERS
from benchmarks.accuracy.unlike import unlike
from benchmarks.frozen.draw import HALVES, frozen
from benchmarks.frozen.solve import frozen_law, is_solved
from benchmarks.laws import law_of
from benchmarks.report import markdown, write_report

TURN, ARMS = PARTS["turn of free rims"], PARTS["arms into free rims"]
MODELS: dict[str, dict[str, Any]] = {"both": {}, "no turn": TURN, "no arms": ARMS, "neither": TURN | ARMS}
CAP_PERCENT = 6.0  # sheets that take another form count with this, so that a few of them do not decide a mean

Row = dict[str, Any]


def solved(folder: Path, frozen_folder: Path) -> Iterator[tuple[str, Design, Law, Path]]:
    """Set, design, law and folder of the free designs with an exact shape and a law."""
    paper = load_law()
    known = {"ribbons": ribbons(), "equal stars": even(), "unlike": unlike(OTHERS)}
    every = [(name, design, folder) for name, designs in known.items() for design in designs]
    drawn = [(kind, design) for half in HALVES for kind, design in frozen(half)]
    names = {True: "frozen ribbons", False: "frozen, not ribbons"}
    every += [(names[kind == "ribbon"], design, frozen_folder) for kind, design in drawn]
    for name, design, its in every:
        if design.pins or not is_solved(design, its):
            continue
        try:
            yield name, design, frozen_law(design, its) if its is frozen_folder else law_of(design, paper), its
        except LawError:
            continue


def measured(name: str, design: Design, law: Law, folder: Path) -> Row:
    """Distances of the previews in % of the diameter, by the parts that are on."""
    plan, exact, mean = print_layout(design), lowest(design, folder), None
    same, distance = symmetries(design, plan), {}
    for parts, changed in MODELS.items():
        model = replace(PREVIEW_MODEL, **changed)
        compared = compare_shapes(exact, preview(design, law, model=model), plan, same, design.gravity.pull, mean)
        distance[parts], mean = float(compared.rms_percent), compared.mean
    return {"set": name, "design": design.name, "rms_percent": distance}


def section(rows: Sequence[Row]) -> str:
    """Markdown: median, nine in ten and capped mean of each set."""
    lines = []
    for name in [*dict.fromkeys(row["set"] for row in rows), "all"]:
        some = [row["rms_percent"] for row in rows if name in ("all", row["set"])]
        line = [name, str(len(some))]
        for parts in MODELS:
            of = np.array([each[parts] for each in some])
            line.append(f"{np.median(of):.2f}, {np.quantile(of, 0.9):.2f}, {np.minimum(of, CAP_PERCENT).mean():.2f}")
        lines.append(line)
    table = markdown(["set", "designs", *MODELS], lines)
    return f"{table}\n\nDistances rms in % of the diameter: median, nine in ten, mean with at most {CAP_PERCENT:g} %."


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.free_rims")
    parser.add_argument("folder", type=Path)
    parser.add_argument("frozen_folder", type=Path)
    options = parser.parse_args()
    rows = []
    for known in solved(options.folder, options.frozen_folder):
        rows.append(measured(*known))
        print(rows[-1], flush=True)
    text = section(rows)
    print(text)
    write_report(
        "accuracy.free_rims", rows, text, command="python -m benchmarks.accuracy.free_rims FOLDER FROZEN_FOLDER"
    )


if __name__ == "__main__":
    main()
