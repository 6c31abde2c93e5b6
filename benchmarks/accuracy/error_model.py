"""The three constants of the preview's error model, fitted together on one set of designs and judged on another.

python -m benchmarks.accuracy.error_model

Takes the comparisons that benchmarks/results keeps, in seconds. A comparison by an older program lacks some sources of
the error; it gets them from a new preview if that has the same shape, and else is left out and named. So after a change
of the preview, first run the commands that compare (benchmarks.accuracy.expectation, .held and .canopy_sweep, and
benchmarks.frozen.compare for both halves), then this one, and put the numbers into asterism/previews/model.py.

The fit minimises the quantile loss at 0.9 of the logarithm of error over estimate, for distances and heights together:
nine of ten are then within their estimate. It sees the study, the designs drawn beside it and sheets on few supports.
The frozen designs and the sweep of canopies judge it. Each kind of sheet is also predicted by a fit to the others.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import minimize

from asterism.equilibrium.arrays import Floats
from asterism.fem.search.stiffness_response import STIFFNESSES
from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law_file import load_law
from asterism.pattern.design.design import Design
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.run import preview
from asterism.previews.uncertainty.distance_error import distance_error_percent
from asterism.previews.uncertainty.error_sources import ErrorSources
from asterism.previews.uncertainty.height_doubts import HeightDoubts
from asterism.previews.uncertainty.height_error import height_error_percent
from asterism.previews.uncertainty.other_forms import OtherForm
from benchmarks.accuracy.finished import is_same_shape
from benchmarks.accuracy.report import FAR, HEIGHT_FAR, missed
from benchmarks.report import RESULTS, markdown, write_report

CONSTANTS = ("energy_uncertainty", "stiffness_uncertainty", "buckling_share")
FITTED, JUDGING = (
    ("accuracy.expectation", "accuracy.held"),
    ("frozen.working", "frozen.sealed", "accuracy.canopy_sweep"),
)
STARTS = ((0.05, 0.35, 0.2), (0.1, 0.1, 0.1), (0.03, 0.5, 0.1))
QUANTILE = 0.9
CLOSE = 1.0  # % of the diameter
# constants that a smaller model leaves out
SMALLER: dict[str, tuple[str, ...]] = {
    "without stiffnesses": ("stiffness_uncertainty",),
    "without narrow sheets": ("buckling_share",),
    "energy alone": ("stiffness_uncertainty", "buckling_share"),
}
HEADER = [
    "", "designs", "distances within the estimate", "supported", "free", "misses", "announced by the estimate",
    f"within {CLOSE:g} %", "announced too", "heights within the estimate", f"heights off by more than {HEIGHT_FAR:g} %",
    "announced", "other heights", "announced too", "loss",
]  # fmt: skip


@dataclass(frozen=True)
class Compared:
    """A comparison with an exact shape: the row as it is kept, a kind of sheet, and the sources of the estimate."""

    row: dict[str, Any]
    kind: str
    sources: ErrorSources

    @property
    def height_error_mm(self) -> float:
        """Absolute error; smaller ones than the mesh error of the exact shape count as that."""
        least = 0.01 * PREVIEW_MODEL.mesh_error_percent * self.sources.diameter_mm
        return max(abs(float(np.subtract(*self.row["heights_mm"]))), least)


def main() -> None:
    left_out = list[str]()
    fitted_to, judging = (list(_compared(names, left_out)) for names in (FITTED, JUDGING))
    text = section(fitted_to, judging)
    if left_out:
        text += f"\n\nWithout the sources of an estimate, and left out: {', '.join(left_out)}."
    print(text)
    rows = [
        {"name": each.row["name"], "kind": each.kind, "set": name}
        | {key: each.row[key] for key in ("rms_percent", "same_branch", "height_error_percent")}
        | _estimates(each, PREVIEW_MODEL)
        for name, some in (("fitted", fitted_to), ("judging", judging))
        for each in some
    ]
    write_report("accuracy.error_model", rows, text)


def section(fitted_to: Sequence[Compared], judging: Sequence[Compared]) -> str:
    """Markdown."""
    best, everything = fitted(fitted_to), [*fitted_to, *judging]
    kinds = sorted({each.kind for each in everything})
    without = {kind: fitted([each for each in everything if each.kind != kind]) for kind in kinds}
    lines = [
        ["fitted to", *goodness(fitted_to, lambda _: best)],
        ["judging, by that fit", *goodness(judging, lambda _: best)],
        ["judging, by the constants in use", *goodness(judging, lambda _: PREVIEW_MODEL)],
        ["judging, as the comparisons state it", *goodness(judging, None)],
        ["all, each kind by a fit to the others", *goodness(everything, lambda each: without[each.kind])],
    ]
    for name, zero in SMALLER.items():
        smaller = fitted(fitted_to, zero)
        for group, some in (("fitted to", fitted_to), ("judging", judging)):
            lines.append([f"{group}, {name}", *goodness(some, lambda _, model=smaller: model)])  # type: ignore[misc]
    for kind in kinds:
        some = [each for each in everything if each.kind == kind]
        lines.append([kind, *goodness(some, lambda each: without[each.kind])])
    ranges = np.array([[getattr(model, name) for name in CONSTANTS] for model in without.values()])
    constants = [
        ["in use", *(f"{getattr(PREVIEW_MODEL, name):.3f}" for name in CONSTANTS)],
        ["fitted", *(f"{getattr(best, name):.3f}" for name in CONSTANTS)],
        [
            "fitted to all but one kind",
            *(f"{low:.3f} to {high:.3f}" for low, high in zip(*np.quantile(ranges, [0, 1], axis=0), strict=True)),
        ],
    ]
    return "\n\n".join([markdown(["", *CONSTANTS], constants), markdown(HEADER, lines)])


def fitted(some: Sequence[Compared], zero: Sequence[str] = ()) -> PreviewModel:
    """The model with the constants that fit comparisons best; those of `zero` are left out."""
    free = [name for name in CONSTANTS if name not in zero]

    def model(values: Floats) -> PreviewModel:
        constants: dict[str, Any] = dict.fromkeys(zero, 0.0) | dict(zip(free, np.abs(values).tolist(), strict=True))
        return replace(PREVIEW_MODEL, **constants)

    found = [
        minimize(
            lambda values: loss(some, model(values)),
            [value for name, value in zip(CONSTANTS, start, strict=True) if name in free],
            method="Nelder-Mead",
            options={"xatol": 1e-4, "fatol": 1e-6},
        )
        for start in STARTS
    ]
    return model(min(found, key=lambda each: float(each.fun)).x)


def loss(some: Sequence[Compared], model: PreviewModel) -> float:
    """Mean quantile loss of the logarithms of distances and heights over their estimates; inf for no estimate."""
    if model.energy_uncertainty == 0.0:
        return math.inf
    return _loss(some, [_estimates(each, model) for each in some])


def _loss(some: Sequence[Compared], estimates: Sequence[dict[str, Any]]) -> float:
    pairs = list(zip(some, estimates, strict=True))
    logarithms = (
        np.log([each.row["rms_percent"] / estimate["expected_rms_percent"] for each, estimate in pairs]),
        np.log(
            [
                100.0 * each.height_error_mm / (each.sources.height.height * estimate["expected_height_percent"])
                for each, estimate in pairs
                if each.sources.height and estimate["expected_height_percent"]
            ]
        ),
    )
    return sum(float(np.mean(np.maximum(QUANTILE * x, (QUANTILE - 1.0) * x))) for x in logarithms if len(x))


def goodness(some: Sequence[Compared], model_of: Callable[[Compared], PreviewModel] | None) -> list[str]:
    """The columns of `HEADER` after the first, with the model for each comparison; None takes the estimates kept."""
    estimates = [_estimates(each, model_of(each) if model_of else None) for each in some]
    rows = [each.row | estimate for each, estimate in zip(some, estimates, strict=True)]
    groups = [rows, *([row for row in rows if bool(row["design"].get("pins")) == held] for held in (True, False))]
    covered = [
        f"{sum(r['rms_percent'] <= r['expected_rms_percent'] for r in group)} of {len(group)}" for group in groups
    ]
    far, close = [r for r in rows if missed(r)], [r for r in rows if r["rms_percent"] <= CLOSE]
    heights = [r for r in rows if r["expected_height_percent"] is not None]
    within = sum(abs(r["height_error_percent"]) <= r["expected_height_percent"] for r in heights)
    high, other = (
        [r for r in heights if (abs(r["height_error_percent"]) > HEIGHT_FAR) == off] for off in (True, False)
    )
    return [
        str(len(rows)), *covered, str(len(far)), str(_above(far, "expected_rms_percent", FAR)), str(len(close)),
        str(_above(close, "expected_rms_percent", FAR)), f"{within} of {len(heights)}", str(len(high)),
        str(_above(high, "expected_height_percent", HEIGHT_FAR)), str(len(other)),
        str(_above(other, "expected_height_percent", HEIGHT_FAR)), f"{_loss(some, estimates):.3f}",
    ]  # fmt: skip


def _above(rows: Sequence[dict[str, Any]], key: str, limit: float) -> int:
    return sum(row[key] > limit for row in rows)


def _estimates(each: Compared, model: PreviewModel | None) -> dict[str, Any]:
    if model is None:
        return {key: each.row[key] for key in ("expected_rms_percent", "expected_height_percent")}
    return {
        "expected_rms_percent": distance_error_percent(each.sources, model),
        "expected_height_percent": height_error_percent(each.sources, model),
    }


def _compared(names: Sequence[str], left_out: list[str]) -> Iterator[Compared]:
    """The comparisons of these results that have an estimate; names of those without its sources go to `left_out`."""
    law = load_law()
    for name in names:
        for row in json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8"))["rows"]:
            if row["expected_rms_percent"] is None:
                continue
            shown = row["preview"]
            if "stiffness_percent" not in shown:
                try:
                    shown = preview(Design.from_dict(row["design"]), law).summary
                except LawError:
                    shown = None
                if shown is None or not is_same_shape(row["preview"], shown):
                    left_out.append(row["name"])
                    continue
            yield Compared(row, f"{name.split('.')[0]}: {row.get('kind') or _kind(row['name'])}", sources_of(shown))


def _kind(name: str) -> str:
    """A kind of sheet by the name of a design."""
    first = name.split("-")[0]
    if first in ("random", "canopy", "held", "unlike"):
        return f"{first}-{name.split('-')[1]}" if name.startswith("canopy-n") else first
    return "small sheets and ribbons" if "-h0." in name else "gallery"


def sources_of(shown: Any) -> ErrorSources:
    """The sources of the estimate, from the summary of a preview."""
    forms = [
        OtherForm(*(form[key] for key in ("start", "energy_n_mm", "gap", "distance_percent")))
        for form in shown["other_forms"]
    ]
    heights, ratio = shown["height_doubts_mm"], shown["size_ratio"]
    return ErrorSources(
        shown["diameter_mm"],
        np.array(shown["soft_amplitudes_percent"]),
        np.array([shown["stiffness_percent"][part] for part in STIFFNESSES]),
        np.inf if ratio is None else ratio,
        tuple(forms),
        HeightDoubts(**heights) if heights else None,
    )


if __name__ == "__main__":
    main()
