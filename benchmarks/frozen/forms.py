"""Why previews miss frozen designs: the search, the energy, or an exact shape that is not sure itself.

python -m benchmarks.frozen.forms FOLDER [NAME ...]    (with names: these only, no report is written)

FOLDER is that of `benchmarks.frozen.solve`. A miss is another form than the exact shape, or a distance of more than
2.5 %. The shell of its preview starts from the smooth surface of the exact shape, freely and on a tether that is
loosened in steps. It may end at a minimum of the exact form that is nearer to the exact shape, by a third or more. If
the energy there is lower than that of the preview, the search has overlooked this minimum; if it is higher, the energy
is wrong. Otherwise the energy has no such minimum. The third set is left out.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from asterism.fem.search.evidence import ShellEquilibrium
from asterism.fem.search.relax import follow
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.search.alternatives import EQUAL_ENERGY
from asterism.previews.session import Preview
from asterism.previews.uncertainty.distance_error import probability_lower
from asterism.previews.uncertainty.other_forms import forms_met
from asterism.shape.cell_mean import CellMean
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.verification.numbers import MAX_FORM_DISTANCE_PERCENT, alike
from asterism.verification.right_shape import MIN_CERTAIN_GAP, gap
from benchmarks.accuracy.__main__ import kept
from benchmarks.accuracy.exact import known
from benchmarks.accuracy.report import missed
from benchmarks.frozen.draw import CHOSEN_ON, frozen
from benchmarks.frozen.from_exact import minima_from
from benchmarks.frozen.solve import frozen_law
from benchmarks.report import markdown, write_report

NEARER = 2.0 / 3.0  # a minimum is nearer to the exact shape up to this share of the distance of the one shown
HEADER = [
    "design", "rms %", "same form", "nearer minimum, rms %", "its energy %", "nearest listed form, rms %",
    "probability", "other exact minimum, rms %", "its energy %", "exact, two meshes %", "cause", "exact shape",
]  # fmt: skip
SEARCH, ENERGY, FAR_ENERGY, NO_MINIMUM, SHIFTED = CAUSES = (
    "search", "energy, within its uncertainty", "energy, beyond it", "no such minimum", "same minimum, shifted",
)  # fmt: skip

Row = dict[str, Any]


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.frozen.forms")
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    options = parser.parse_args()
    rows = []
    for design in (design for group in CHOSEN_ON for _, design in frozen(group)):
        if options.names and design.name not in options.names:
            continue
        law = frozen_law(design, options.folder)
        compared = kept(design, options.folder, law, starts=False, as_is=False)
        if missed(compared):
            rows.append(_row(design, options.folder, law, compared))
            print("  ".join(_line(rows[-1])), flush=True)
    rows.sort(key=lambda row: (row["same_form"], -row["rms_percent"]))
    text = f"{_counts(rows)}\n\n{markdown(HEADER, [_line(row) for row in rows])}"
    print(text)
    if not options.names:
        write_report("frozen.forms", rows, text, command="python -m benchmarks.frozen.forms FOLDER")


def _row(design: Design, folder: Path, law: Law, compared: Row) -> Row:
    exact = list(known(design, folder).values())
    preview = Preview(design, law)
    preview.shape()
    state, shown = preview.state, preview.state.equilibrium
    means = [CellMean(each.printed, each.weights, state.layout.lattice_vectors) for each in exact]

    def distance(at: ShellEquilibrium, number: int = 0) -> Comparison:
        at = replace(at, x=state.shell.shifted_to_ground(at.x))
        preview.state = replace(state, result=at, resting=at, is_factor_resting=False)
        pull = design.gravity.pull
        return compare_shapes(exact[number], preview.shape(), state.layout, state.symmetries, pull, means[number])

    def share(energy: float) -> float:
        return 100.0 * (energy - shown.energy) / shown.absolute_energy

    own = distance(shown).rms_percent
    minima = minima_from(exact[0], means[0], state.layout.spacing_mm, state.shell, state.factor)
    near = [(distance(each), share(each.energy)) for each in minima]
    near = [(each, energy) for each, energy in near if each.rms_percent <= NEARER * own and alike(each)]
    nearest = min(near, key=lambda pair: pair[0].rms_percent, default=None)
    listed = [
        (distance(follow(state.shell, trial.x, state.factor)).rms_percent, form) for form, trial in forms_met(state)
    ]
    closest = min(listed, key=lambda pair: pair[0], default=None)
    others = [each for each in exact[1:] if each.summary["is_minimum"]]
    is_other = bool(others) and 100.0 * gap(exact[0].summary, others[0].summary) > 1e-4
    row = {
        "name": design.name,
        "rms_percent": own,
        "same_form": bool(compared["same_branch"]),
        "nearer_percent": nearest and nearest[0].rms_percent,
        "nearer_energy_percent": nearest and nearest[1],
        "listed_percent": closest and closest[0],
        "listed_probability": closest and probability_lower(closest[1].gap),
        "other_exact_percent": distance(shown, 1).rms_percent if is_other else None,
        "other_exact_energy_percent": 100.0 * gap(exact[0].summary, others[0].summary) if is_other else None,
        "mesh_change_percent": compared["mesh_change_percent"],
    }
    return row | {"cause": _cause(row), "reference": _reference(row)}


def _cause(row: Row) -> str:
    energy = row["nearer_energy_percent"]
    if energy is None:
        return SHIFTED if row["same_form"] else NO_MINIMUM
    if energy < -100.0 * EQUAL_ENERGY:
        return SEARCH
    return ENERGY if energy < 100.0 * PREVIEW_MODEL.energy_uncertainty else FAR_ENERGY


def _reference(row: Row) -> str:
    """Why the exact shape itself is not sure; empty if it is."""
    doubts = []
    if row["mesh_change_percent"] > row["rms_percent"]:
        doubts.append("changes more between two meshes")
    other, energy = row["other_exact_percent"], row["other_exact_energy_percent"]
    if other is not None and other < min(row["rms_percent"], MAX_FORM_DISTANCE_PERCENT):
        certain = "" if energy < 100.0 * MIN_CERTAIN_GAP else " of clearly higher energy"
        doubts.append(f"the preview is at the other minimum{certain}")
    return "; ".join(doubts)


def _counts(rows: Sequence[Row]) -> str:
    """Markdown: misses by cause."""
    table = []
    for name, some in (
        ("another form", [row for row in rows if not row["same_form"]]),
        ("the same form", [row for row in rows if row["same_form"]]),
    ):
        count = Counter(row["cause"] for row in some)
        unsure = sum(bool(row["reference"]) for row in some)
        causes = [str(count[each]) for each in CAUSES]
        table.append([name, str(len(some)), *causes, str(unsure)])
    return markdown(["misses with", "designs", *CAUSES, "of these the exact shape is unsure"], table)


def _line(row: Row) -> list[str]:
    def number(key: str, digits: int = 2) -> str:
        return "-" if row[key] is None else f"{np.round(row[key], digits) + 0.0:.{digits}f}"

    return [
        row["name"],
        number("rms_percent"),
        "yes" if row["same_form"] else "no",
        *map(number, ("nearer_percent", "nearer_energy_percent", "listed_percent", "listed_probability")),
        number("other_exact_percent"),
        number("other_exact_energy_percent", 3),
        number("mesh_change_percent"),
        row["cause"],
        row["reference"] or "-",
    ]


if __name__ == "__main__":
    main()
