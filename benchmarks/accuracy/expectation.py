"""How good the preview's own expectation is, on designs that it was fitted to and on designs that it was not.

python -m benchmarks.accuracy.expectation FOLDER [--kept]

The numbers of the estimate in `asterism/previews/model.py` belong to the study, 24 further designs and small even
sheets. Here they are fitted again without each of these, which then is predicted; and twelve more are drawn, ribbons,
and designs of other outlines and pins, which no number was ever fitted to. Forty more were drawn later, and fifty after
that. The share of the softness in the heights belongs to the share of the amplitudes in use: after a change of that,
once more with --kept gives it.
FOLDER is that of the study, which comes first; --kept as there: designs without a finished comparison are left out, and
the text names them. As in the study, the exact model starts from the released sheet and from the preview, and the lower
minimum counts. Supported sheets are compared as held.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize

from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.run import preview
from asterism.previews.search.near_zero_modes import has_two_near_zero_modes
from asterism.verification.numbers import MAX_LIKE_DISTANCE_PERCENT
from benchmarks.accuracy import expected_heights
from benchmarks.accuracy.__main__ import kept
from benchmarks.accuracy.designs import RANDOM, designs, drawn, even, ribbons
from benchmarks.accuracy.exact import exact, lowest
from benchmarks.accuracy.expected_heights import AFTERWARDS, PREDICTED
from benchmarks.accuracy.finished import read_row, row_path
from benchmarks.accuracy.report import HEADER, announced, missed, row
from benchmarks.accuracy.unlike import unlike
from benchmarks.report import markdown, write_report
from homogenize.errors import LawError
from homogenize.law.law import Law
from homogenize.law.law_file import load_law
from pattern.design.design import Design

OTHERS = 40  # designs of other outlines and pins
FITTED, UNSEEN = 24, 12  # designs with the seeds that follow the study's, and with those that follow them
LATER, LAST = range(600, 640), range(640, 690)  # seeds
# columns of the study's table
NAMES = [
    "design", "stars", "held", "rms %", "expected %", "same form", "height %", "expected height %", "warnings",
]  # fmt: skip
IN_USE = (PREVIEW_MODEL.floor_percent, PREVIEW_MODEL.amplitude_share)

STUDY, SMALL = "the study and 24 more", "small free sheets of equal stars"
NARROW = "ribbons, never fitted to"
FORTY, FIFTY = "forty more", "fifty drawn after that"
OTHERWISE = "other outlines and pins"

Row = dict[str, Any]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.expectation")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--kept", action="store_true")
    options = parser.parse_args()
    law, left_out = load_law(), list[str]()

    def rows(chosen: Sequence[Design]) -> list[Row]:
        return _rows(chosen, options.folder, law, options.kept, left_out)

    more = [drawn(seed) for seed in range(RANDOM, RANDOM + FITTED + UNSEEN)]
    known, small, unseen = rows([*designs(), *more[:FITTED]]), rows(even()), rows(more[FITTED:])
    narrow, others = rows(ribbons()), rows(unlike(OTHERS))
    later, last = (rows([drawn(seed) for seed in seeds]) for seeds in (LATER, LAST))
    text = section(known, small, unseen, narrow, others, later, last)
    if left_out:
        text += f"\n\nNot compared as held yet, and left out: {', '.join(left_out)}."
    print(text)
    write_report("accuracy.expectation", [*known, *small, *unseen, *narrow, *others, *later, *last], text)


def _rows(chosen: Sequence[Design], folder: Path, law: Law, as_is: bool, left_out: list[str]) -> list[Row]:
    """Those that have a law and an exact minimum; names of designs that have no comparison yet go to `left_out`."""
    rows = []
    for design in chosen:
        try:
            law.check(design)
        except LawError:
            continue
        if as_is and read_row(row_path(folder, design, starts=False), design) is None:
            left_out.append(design.name)
            continue
        if not as_is:
            exact(design, folder, near=lambda design=design: preview(design, law))  # type: ignore[misc]
            if not lowest(design, folder).summary["is_minimum"]:
                print(f"{design.name}: the exact model has found no certain shape", flush=True)
                continue
        entry = kept(design, folder, law, starts=False, as_is=as_is)
        shown = entry["preview"]
        rows.append(entry | {"amplitude": math.hypot(*shown["soft_amplitudes_percent"], shown["contrast_percent"])})
        print("  ".join(row(rows[-1])), flush=True)
    return rows


def section(
    study: Sequence[Row],
    small: Sequence[Row],
    unseen: Sequence[Row],
    narrow: Sequence[Row],
    others: Sequence[Row],
    later: Sequence[Row],
    last: Sequence[Row],
) -> str:
    """Markdown."""
    known = [*study, *small]
    fits = [fitted([entry for entry in known if entry is not left_out]) for left_out in known]
    again = [entry | {"expected_rms_percent": _again(entry, fit)} for entry, fit in zip(known, fits, strict=True)]
    groups = [
        (STUDY, study),
        (SMALL, small),
        (PREDICTED, again),
        (AFTERWARDS, unseen),
        (NARROW, narrow),
        (OTHERWISE, others),
        (FORTY, later),
        (FIFTY, last),
    ]
    lines = [[name, *_goodness(rows)] for name, rows in groups if rows]
    header = [
        "", "designs", "supported", "rms, median %", "nine in ten %", "distance over expected, median", "nine in ten",
        "misses", "of these announced", "announced in all",
    ]  # fmt: skip
    numbers = [["floor %", "share of the amplitudes"]]
    numbers += [[f"{x:.3f}" for x in fit] for fit in (IN_USE, fitted(known))]
    numbers += [
        [f"{low:.3f} to {high:.3f}" for low, high in zip(np.min(fits, axis=0), np.max(fits, axis=0), strict=True)]
    ]
    others_too = {OTHERWISE: others, FORTY: later, FIFTY: last}
    names = ["", "in use", "fitted", "fitted without one"]
    tables = [
        [[cells[HEADER.index(name)] for name in NAMES] for cells in map(row, rows)]
        for rows in (small, unseen, narrow, others, list(filter(missed, [*later, *last])))
    ]
    return "\n\n".join(
        [
            markdown(header, lines),
            markdown(
                [names[0], *numbers[0]], [[name, *line] for name, line in zip(names[1:], numbers[1:], strict=True)]
            ),
            "Heights:",
            expected_heights.section({STUDY: study, SMALL: small}, unseen, others_too),
            "Small free sheets of equal stars (lengths l and thicknesses h in mm):",
            markdown(NAMES, tables[0]),
            "The designs drawn afterwards:",
            markdown(NAMES, tables[1]),
            "Ribbons, one to four rows of stars:",
            markdown(NAMES, tables[2]),
            "Other outlines and pins (`benchmarks/accuracy/unlike.py`):",
            markdown(NAMES, tables[3]),
            "The ninety drawn last, those that miss:",
            markdown(NAMES, tables[4]),
        ]
    )


def fitted(rows: Sequence[Row]) -> tuple[float, ...]:
    """Floor and share: least squares of the logarithms, then scaled from the median to the mean square.

    From designs within 10 % of the exact shape that are not soft in two ways.
    """
    some = [entry for entry in rows if entry["rms_percent"] < MAX_LIKE_DISTANCE_PERCENT and not _two_ways(entry)]
    size = np.array([entry["amplitude"] for entry in some])
    distance = np.log([entry["rms_percent"] for entry in some])

    def off(w: np.ndarray) -> np.ndarray:
        return np.asarray(distance - np.log(np.hypot(w[0], w[1] * size)))

    best = minimize(lambda w: float((off(w) ** 2).sum()), IN_USE, method="Nelder-Mead").x
    return tuple(float(x) for x in np.abs(best) * np.exp(off(best).var()))


def _again(entry: Row, fit: tuple[float, ...]) -> float | None:
    """What another fit expects: the part for the near form is exchanged, that for other forms stays."""
    if entry["expected_rms_percent"] is None:
        return None
    form = entry["expected_rms_percent"] ** 2 - _near(entry, IN_USE) ** 2
    return float(np.sqrt(max(form, 0.0) + _near(entry, fit) ** 2))


def _near(entry: Row, fit: tuple[float, ...]) -> float:
    return math.hypot(fit[0], fit[1] * entry["amplitude"])


def _two_ways(entry: Row) -> bool:
    return has_two_near_zero_modes(entry["preview"]["soft_amplitudes_percent"])


def _goodness(rows: Sequence[Row]) -> list[str]:
    ratio = [
        entry["rms_percent"] / entry["expected_rms_percent"]
        for entry in rows
        if entry["expected_rms_percent"] is not None
    ]
    far, rms = [entry for entry in rows if missed(entry)], [entry["rms_percent"] for entry in rows]
    return [
        str(len(rows)),
        str(sum(bool(entry["design"].get("pins")) for entry in rows)),
        f"{np.median(rms):.2f}",
        f"{np.quantile(rms, 0.9):.2f}",
        f"{np.median(ratio):.2f}",
        f"{np.quantile(ratio, 0.9):.2f}",
        str(len(far)),
        str(sum(map(announced, far))),
        str(sum(map(announced, rows))),
    ]


if __name__ == "__main__":
    main()
