"""The exact shapes of the frozen designs, from the released sheet and from the preview.

python -m benchmarks.frozen.solve FOLDER [--half sealed | second | third] [NAME ...] [--table]

FOLDER keeps shapes, as in the study (`benchmarks.accuracy.exact`), and laws of stars with four to six arms; finished
ones are not computed again. The preview is a start of the exact model and is compared with nothing: that would open
the sealed designs. --table solves nothing, and writes energies and certificates of all shapes in FOLDER, of both
halves and the later sets, into benchmarks/results.
"""

from __future__ import annotations

import argparse
from functools import cache
from pathlib import Path
from typing import Any

from asterism.homogenize.errors import ForeignLaw
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.laws.calibrate import calibrate
from asterism.laws.design_law import material_for_design
from asterism.pattern.design.design import Design
from asterism.previews.run import preview
from asterism.shape.shape import Shape
from benchmarks.accuracy.exact import exact, known
from benchmarks.frozen.draw import GROUPS, WORKING, frozen
from benchmarks.report import markdown, write_report

JOBS = 1  # processes that make a law
KEPT = ("energy_n_mm", "is_minimum", "smallest_eigenvalue", "height_mm", "vertices", "iterations", "wall_s")
HEADER = [
    "design", "half", "vertices", "N mm from the release", "N mm from the preview", "counts", "height mm, release",
    "preview", "seconds",
]  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.frozen.solve")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--half", choices=GROUPS, default=WORKING)
    parser.add_argument("--table", action="store_true")
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    if options.table:
        rows = [row(design, half, options.folder) for half in GROUPS for _, design in frozen(half)]
        there = [each for each in rows if each["shapes"]]
        text = f"{len(there)} of {len(rows)} designs.\n\n{markdown(HEADER, [_line(each) for each in there])}"
        print(text)
        write_report("frozen.solve", there, text)
        return
    for _, design in frozen(options.half):
        if not options.names or design.name in options.names:
            shapes = solved(design, options.folder)
            seconds = sum(shape.summary["wall_s"] for shape in shapes.values())
            minima = " ".join("minimum" if shape.summary["is_minimum"] else "NO MINIMUM" for shape in shapes.values())
            print(f"{design.name}  {seconds:.1f} s  {minima}", flush=True)


def solved(design: Design, folder: Path) -> dict[str, Shape]:
    """The exact shapes by their start, that which counts first (`benchmarks.accuracy.exact.known`)."""
    exact(design, folder)
    exact(design, folder, near=lambda: preview(design, frozen_law(design, folder)))
    return known(design, folder)


def row(design: Design, half: str, folder: Path) -> dict[str, Any]:
    """Energy, certificate, height and cost of the exact shapes of a design that the folder has, by their start."""
    shapes = known(design, folder) if is_solved(design, folder) else {}
    return {
        "name": design.name,
        "half": half,
        "shapes": {start: {key: shape.summary[key] for key in KEPT} for start, shape in shapes.items()},
    }


def _line(row: dict[str, Any]) -> list[str]:
    first, *_ = row["shapes"]
    one, other = (row["shapes"][start] for start in ("release", "preview"))
    return [
        row["name"],
        row["half"],
        str(one["vertices"]),
        *(f"{each['energy_n_mm']:.3f}" + ("" if each["is_minimum"] else " (no minimum)") for each in (one, other)),
        first,
        *(f"{each['height_mm']:.2f}" for each in (one, other)),
        f"{one['wall_s'] + other['wall_s']:.0f}",
    ]


def is_solved(design: Design, folder: Path) -> bool:
    """Whether the folder has both exact shapes."""
    return all((folder / design.name / start / "summary.json").exists() for start in ("released", "near"))


def frozen_law(design: Design, folder: Path) -> Law:
    """The paper's law, or one of the design's own stars, which the folder keeps.

    Raises
    ------
    CampaignError
        The design's stars have no law.
    """
    law = _paper_law()
    try:
        law.check(design)
    except ForeignLaw:
        return _own_law(design, folder)
    return law


@cache
def _paper_law() -> Law:
    return load_law()


def _own_law(design: Design, folder: Path) -> Law:
    file = folder / "laws" / f"{design.name}.npz"
    if file.exists():
        return load_law(file)
    file.parent.mkdir(parents=True, exist_ok=True)
    return calibrate(material_for_design(design), file, JOBS)


if __name__ == "__main__":
    main()
