"""The constants of the preview that are fitted to sheets, chosen together on one half of the frozen designs.

python -m benchmarks.fit_constants FOLDER [--write]

FOLDER is that of `benchmarks.frozen.solve`. The constants that change a shape are tried at factors of their values, one
after the other, on the working half. A value is taken if the distances become smaller by more than `MIN_GAIN_ERRORS`
standard errors, and its neighbours are tried again until none is better. The other half of the first set, on which this
command chooses nothing, shows how far the choice holds. The estimated errors are fitted after the shapes
(`benchmarks.accuracy.error_model`).

The measure of a choice is the mean logarithm of the distance, as the supports hold the sheet, in % of the diameter, at
least `FLOOR_PERCENT`: the exact shapes themselves differ by that from mesh to mesh. A few sheets that take another form
do not decide it.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.layout.symmetries import Symmetry, symmetries
from asterism.previews.model import PREVIEW_MODEL, PreviewModel, describe
from asterism.previews.run import preview
from asterism.shape.cell_mean import CellMean
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from benchmarks.accuracy.error_model import CONSTANTS
from benchmarks.accuracy.exact import lowest
from benchmarks.frozen.draw import SEALED, WORKING, frozen
from benchmarks.frozen.solve import frozen_law, is_solved
from benchmarks.report import markdown, write_report

FACTORS = (0.67, 1.5)
MIN_GAIN_ERRORS = 2.0
FLOOR_PERCENT = 0.15
# these constants decide the estimate of the preview's error, not its shape
ESTIMATES = CONSTANTS
HEADER = [
    "constant", "factor", "value", "gain %, working half", "its standard error", "gain %, other half",
    "its standard error",
]  # fmt: skip

Row = dict[str, Any]


@dataclass(frozen=True)
class Judged:
    """A design with everything that its previews are compared with."""

    design: Design
    law: Law
    exact: Shape
    layout: Layout
    symmetries: Sequence[Symmetry]
    mean: CellMean

    def distance(self, model: PreviewModel) -> float:
        """% of the diameter; infinite if the law or the search refuses the sheet."""
        try:
            shape = preview(self.design, self.law, model=model)
        except LawError:
            return np.inf
        pull = self.design.gravity.pull
        comparison = compare_shapes(self.exact, shape, self.layout, self.symmetries, pull, mean=self.mean)
        return float(comparison.rms_percent)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fit_constants")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    halves = {half: list(judged(half, options.folder)) for half in (WORKING, SEALED)}
    model, rows = chosen(halves)
    text = section(rows, model, {half: len(designs) for half, designs in halves.items()})
    print(text)
    if options.write:
        write_report("fit_constants", rows, text, command="python -m benchmarks.fit_constants FOLDER --write")


def shape_constants() -> list[str]:
    """Names of the constants that are fitted to sheets and change a shape."""
    names = [each.name for each in fields(PreviewModel)]
    return [name for name in names if describe(name).origin == "fitted to sheets" and name not in ESTIMATES]


def judged(half: str, folder: Path) -> Iterator[Judged]:
    """The designs of a half that the folder has exact shapes of."""
    for _, design in frozen(half):
        if is_solved(design, folder):
            exact, plan = lowest(design, folder), print_layout(design)
            mean = CellMean(exact.printed, exact.weights, plan.lattice_vectors)
            yield Judged(design, frozen_law(design, folder), exact, plan, symmetries(design, plan), mean)


def logarithms(designs: Sequence[Judged], model: PreviewModel) -> Floats:
    """(n,) logarithm of the distances of the previews with a model, in % of the diameter."""
    return np.log(np.clip([design.distance(model) for design in designs], FLOOR_PERCENT, 100.0))


def chosen(halves: Mapping[str, Sequence[Judged]]) -> tuple[PreviewModel, list[Row]]:
    """The model after all changes that gain, and the gains of other values around it, on both halves."""
    model, is_better = PREVIEW_MODEL, True
    while is_better:
        is_better, rows = False, []
        base = {half: logarithms(designs, model) for half, designs in halves.items()}
        for name in shape_constants():
            tried = [tried_value(name, factor, model, base, halves) for factor in FACTORS]
            best = max(tried, key=lambda row: row["gains"][WORKING][0])
            print("  ".join(_line(best)), flush=True)
            gain, error = best["gains"][WORKING]
            if gain > MIN_GAIN_ERRORS * error:
                model, is_better = replace(model, **{name: best["value"]}), True
                base = {half: logarithms(designs, model) for half, designs in halves.items()}
            rows += tried
    return model, rows


def tried_value(
    name: str,
    factor: float,
    model: PreviewModel,
    base: Mapping[str, Floats],
    halves: Mapping[str, Sequence[Judged]],
) -> Row:
    """The gains of a factor of a constant by half: mean in %, and its standard error over the designs."""
    value = factor * getattr(model, name)
    gains = {}
    for half, designs in halves.items():
        gain = 100.0 * (base[half] - logarithms(designs, replace(model, **{name: value})))
        gains[half] = float(gain.mean()), float(gain.std(ddof=1) / np.sqrt(len(gain)))
    return {"constant": name, "factor": factor, "value": value, "gains": gains}


def section(rows: Sequence[Row], model: PreviewModel, counts: Mapping[str, int]) -> str:
    """Markdown."""
    values = [f"{name} = {getattr(model, name):.3g}" for name in shape_constants()]
    kept = "as they are" if model == PREVIEW_MODEL else "not as they are in the preview"
    head = f"{counts[WORKING]} and {counts[SEALED]} designs. Chosen values, {kept}: {', '.join(values)}."
    return f"{head}\n\n{markdown(HEADER, [_line(row) for row in rows])}"


def _line(row: Row) -> list[str]:
    gains = [text for half in (WORKING, SEALED) for text in _with_error(*row["gains"][half])]
    return [row["constant"], f"{row['factor']:g}", f"{row['value']:.3g}", *gains]


def _with_error(gain: float, error: float) -> tuple[str, str]:
    return f"{gain:+.1f}", f"{error:.1f}"


if __name__ == "__main__":
    main()
