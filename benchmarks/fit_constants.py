"""What the parts and the fitted constants of the preview gain, on the frozen designs.

python -m benchmarks.fit_constants FOLDER [--write]

FOLDER is that of `benchmarks.accuracy`. First each part of the model is turned off, on all designs that models may be
chosen on. Then the constants that are fitted to sheets are tried at factors of their values, one after the other, on
the working half. A value is taken if the distances become smaller by more than `MIN_GAIN_ERRORS` standard errors, and
its neighbours are tried again until none is better. The other half of the first set, on which this command chooses
nothing, shows how far the choice holds.

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
from asterism.homogenize.errors import LawError
from asterism.previews.fields.sheet_fields import PARTS, without
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from benchmarks.frozen.draw import CHOSEN_ON, SEALED, WORKING, frozen
from benchmarks.report import markdown, write_report
from benchmarks.solved import NEAR, Solved

FITTED = tuple(each.name for each in fields(PreviewModel) if each.name != "off")
FACTORS = (0.67, 1.5)
MIN_GAIN_ERRORS = 2.0
FLOOR_PERCENT = 0.3
PARTS_HEADER = ["part turned off", "designs that it changes", "mean gain %", "its standard error"]
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
    sets = {
        group: [each for _, design in frozen(group) if (each := Solved(design, options.folder)).has(NEAR)]
        for group in CHOSEN_ON
    }
    halves = {half: sets[half] for half in (WORKING, SEALED)}
    if min(map(len, halves.values())) < 2:
        parser.error(f"FOLDER: {options.folder} has fewer than two solved designs of a half: benchmarks.accuracy")
    text = parts([design for designs in sets.values() for design in designs])
    model, rows = chosen(halves)
    text += "\n\n" + section(rows, model, {half: len(designs) for half, designs in halves.items()})
    print(text)
    if options.write:
        write_report("fit_constants", text, "python -m benchmarks.fit_constants FOLDER --write")


def parts(designs: Sequence[Solved]) -> str:
    """Markdown: what each part of the model gains, the largest gain first."""
    base, lines = logarithms(designs, PREVIEW_MODEL), []
    for part in PARTS:
        gain = 100.0 * (logarithms(designs, without(part)) - base)
        mean, error = gain.mean(), gain.std(ddof=1) / np.sqrt(len(gain))
        changed = int((np.abs(gain) > 1.0).sum())
        lines.append((mean, [part, str(changed), f"{mean:+.1f}", f"{error:.1f}"]))
        print("  ".join(lines[-1][1]), flush=True)
    rows = [line for _, line in sorted(lines, key=lambda each: -each[0])]
    return f"{len(designs)} designs.\n\n{markdown(PARTS_HEADER, rows)}"


def logarithms(designs: Sequence[Solved], model: PreviewModel) -> Floats:
    """(n,) logarithm of the distances of the previews with a model, in % of the diameter."""
    return np.log(np.clip([_distance(design, model) for design in designs], FLOOR_PERCENT, 100.0))


def _distance(design: Solved, model: PreviewModel) -> float:
    try:
        return design.compared(model).rms_percent
    except LawError:  # neighbours contract too differently with these constants
        return np.inf


def chosen(halves: Mapping[str, Sequence[Solved]]) -> tuple[PreviewModel, list[Row]]:
    """The model after all changes that gain, and the gains of other values around it, on both halves."""
    model, is_better = PREVIEW_MODEL, True
    while is_better:
        is_better, rows = False, []
        base = {half: logarithms(designs, model) for half, designs in halves.items()}
        for name in FITTED:
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
    name: str, factor: float, model: PreviewModel, base: Mapping[str, Floats], halves: Mapping[str, Sequence[Solved]]
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
    values = [f"{name} = {getattr(model, name):.3g}" for name in FITTED]
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
