"""How far each part moves the previews of the study and of the sheets on few supports, without their exact shapes.

python -m benchmarks.frozen.shifts [--part PART ...]

The distance of two previews, with and without the part, bounds the change of the distance to the exact shape. The
exact heights stand in benchmarks/results, so that the errors of the height are compared too.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.model_parts import PARTS, without
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from benchmarks.report import RESULTS, markdown

SOURCES = ("accuracy", "accuracy.held")
MIN_SHIFT_PERCENT = 0.1  # of the diameter
HEADER = [
    "part turned off", "designs", f"moved by {MIN_SHIFT_PERCENT} % or more", "median %", "nine in ten %", "largest %",
    "error of the height, median %, with", "without", "within 6 %, with", "without", "moved most",
]  # fmt: skip

Shift = tuple[str, float, float, float]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.frozen.shifts")
    parser.add_argument("--part", action="append", choices=PARTS)
    options = parser.parse_args()
    parts = options.part or list(PARTS)
    shifts: dict[str, list[Shift]] = {part: [] for part in parts}
    for source in SOURCES:
        for row in json.loads((RESULTS / f"{source}.json").read_text(encoding="utf-8"))["rows"]:
            for part, shift in shifts_of(row, parts).items():
                shifts[part].append(shift)
                print(
                    f"{part:<30} {shift[0]:<20} {shift[1]:.3f} %, height {shift[2]:.1f} -> {shift[3]:.1f} %", flush=True
                )
    print(markdown(HEADER, [_line(part, shifts[part]) for part in parts]))


def shifts_of(row: dict[str, Any], parts: list[str]) -> dict[str, Shift]:
    """By part: name, rms distance of both previews in % of the diameter, errors in % of the height with and without."""
    design = Design.from_dict(row["design"])
    exact = row["heights_mm"][0]
    plan = layout(design)
    try:
        shown = preview(design, plan=plan)
    except LawError:
        return {}
    found, same = {}, symmetries(design, plan)
    for part in parts:
        other = preview(design, model=without(part), plan=plan)
        compared = compare_shapes(shown, other, plan, same, design.gravity.pull)
        errors = (100.0 * abs(height / exact - 1.0) for height in compared.heights_mm)
        found[part] = (design.name, compared.rms_percent, *errors)
    return found


def _line(part: str, shifts: list[Shift]) -> list[str]:
    rms, before, after = np.array([shift[1:] for shift in shifts]).T
    most = sorted(shifts, key=lambda shift: -shift[1])[:4]
    return [
        part,
        str(len(shifts)),
        str(int((rms >= MIN_SHIFT_PERCENT).sum())),
        *(f"{np.quantile(rms, share):.2f}" for share in (0.5, 0.9, 1.0)),
        *(f"{np.median(errors):.1f}" for errors in (before, after)),
        *(f"{int((errors <= 6.0).sum())}" for errors in (before, after)),
        ", ".join(f"{name} {shift:.2f}" for name, shift, *_ in most),
    ]


if __name__ == "__main__":
    main()
