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
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.previews.model import PREVIEW_MODEL, PreviewModel, describe
from benchmarks.accuracy.comparisons import Reference, is_solved
from benchmarks.accuracy.error_model import CONSTANTS
from benchmarks.frozen.draw import SEALED, WORKING, frozen
from benchmarks.report import markdown, write_report

FACTORS = (0.67, 1.5)
MIN_GAIN_ERRORS = 2.0
FLOOR_PERCENT = 0.15
HEADER = [
    "constant", "factor", "value", "gain %, working half", "its standard error", "gain %, other half",
    "its standard error",
]  # fmt: skip

Row = dict[str, Any]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fit_constants")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    halves = {
        half: [Reference(design, options.folder) for _, design in frozen(half) if is_solved(design, options.folder)]
        for half in (WORKING, SEALED)
    }
    if min(map(len, halves.values())) < 2:
        parser.error(f"FOLDER: {options.folder} has fewer than two solved designs of a half: benchmarks.frozen.solve")
    model, rows = chosen(halves)
    text = section(rows, model, {half: len(designs) for half, designs in halves.items()})
    print(text)
    if options.write:
        write_report("fit_constants", text, "python -m benchmarks.fit_constants FOLDER --write")


def shape_constants() -> list[str]:
    """Names of the constants that are fitted to sheets and change a shape, not the estimate of its error."""
    names = [each.name for each in fields(PreviewModel)]
    return [name for name in names if describe(name).origin == "fitted to sheets" and name not in CONSTANTS]


def logarithms(designs: Sequence[Reference], model: PreviewModel) -> Floats:
    """(n,) logarithm of the distances of the previews with a model, in % of the diameter."""
    found = [design.compared(model) for design in designs]
    return np.log(np.clip([each.rms_percent if each else np.inf for each in found], FLOOR_PERCENT, 100.0))


def chosen(halves: Mapping[str, Sequence[Reference]]) -> tuple[PreviewModel, list[Row]]:
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
    halves: Mapping[str, Sequence[Reference]],
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
    gains = [
        f"{value:{form}}"
        for half in (WORKING, SEALED)
        for value, form in zip(row["gains"][half], ("+.1f", ".1f"), strict=True)
    ]
    return [row["constant"], f"{row['factor']:g}", f"{row['value']:.3g}", *gains]


if __name__ == "__main__":
    main()
