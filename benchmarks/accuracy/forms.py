"""The forms that a preview meets, each followed by the exact model: which is lower, and can the preview know?

python -m benchmarks.accuracy.forms FOLDER NAME [NAME ...]

FOLDER gets the exact shapes, in DESIGN/form-K.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.session import Preview
from asterism.reports.write_results import write_results
from asterism.shape.comparison import compare_shapes
from asterism.verification.numbers import alike
from benchmarks.accuracy.designs import RANDOM, designs, drawn
from benchmarks.accuracy.expectation import FITTED, UNSEEN
from benchmarks.report import markdown, write_report

HEADER = ["design", "form", "shell N mm", "exact N mm", "exact, above the lowest %", "exact to preview, rms %", "kept"]
APART = 1e-4  # of the energy: trials that differ less are one form


def main(folder: Path, names: list[str]) -> None:
    known = {design.name: design for design in [*designs(), *(drawn(RANDOM + seed) for seed in range(FITTED + UNSEEN))]}
    rows = [row for name in names for row in _rows(known[name], folder)]
    text = markdown(HEADER, [_line(row, rows) for row in rows])
    print(text)
    write_report("accuracy.forms", rows, text)


def _rows(design: Design, folder: Path) -> Iterator[dict[str, Any]]:
    """One for every form, the one that the preview shows first."""
    preview = Preview(design)
    shown, plan = preview.equilibrium, layout(design)
    met = sorted((trial for trial in shown.trials if trial.is_minimum), key=lambda trial: trial.energy != shown.energy)
    energies: list[float] = []
    for trial in met:
        if any(abs(trial.energy - energy) <= APART * abs(energy) for energy in energies):
            continue
        energies.append(trial.energy)
        preview.state = replace(preview.state, result=replace(shown, x=trial.x))
        start = preview.shape()
        exact = exact_shape(design, near=start)
        write_results(exact, folder / design.name / f"form-{len(energies)}")
        comparison = compare_shapes(exact, start, plan, symmetries(design, plan), design.gravity.pull)
        yield {
            "name": design.name,
            "form": trial.name,
            "shell_n_mm": trial.energy,
            "exact_n_mm": exact.summary["energy_n_mm"],
            "is_minimum": exact.summary["is_minimum"],
            "rms_percent": comparison.rms_percent,
            "kept": alike(comparison),
        }


def _line(row: dict[str, Any], rows: list[dict[str, Any]]) -> list[str]:
    lowest = min(other["exact_n_mm"] for other in rows if other["name"] == row["name"])
    return [
        row["name"],
        row["form"],
        f"{row['shell_n_mm']:.2f}",
        f"{row['exact_n_mm']:.2f}" + ("" if row["is_minimum"] else " (no minimum)"),
        f"{100.0 * (row['exact_n_mm'] / lowest - 1.0):.3f}",
        f"{row['rms_percent']:.2f}",
        "yes" if row["kept"] else "no",
    ]


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
