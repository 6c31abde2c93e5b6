"""The three constants of the preview's error model, fitted together on one set of designs and judged on another.

python -m benchmarks.accuracy.error_model FOLDER FROZEN_FOLDER

After a change of the preview, this fits the constants again, for asterism/previews/model.py. FOLDER is that of
`benchmarks.accuracy` and `benchmarks.accuracy.held`, and FROZEN_FOLDER that of `benchmarks.frozen.solve`. The fit sees
the study, the sheets on few supports and the second frozen set; the first set judges it. Designs without exact shapes
are left out.

The fit minimises the quantile loss at 0.9 of the logarithm of error over estimate, for distances and heights together:
nine of ten are then within their estimate.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize

from asterism.fem.search.linear_response import STIFFNESSES
from asterism.homogenize.errors import LawError
from asterism.pattern.design.design import Design
from asterism.previews.error_estimate import ErrorSources, HeightDoubts, distance_error_percent, height_error_percent
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.other_forms import OtherForm
from benchmarks.accuracy.comparisons import FAR, Row, compared, is_solved, missed
from benchmarks.accuracy.designs import canopies, designs, other_held
from benchmarks.accuracy.tables import CLOSE
from benchmarks.frozen.draw import HALVES, SECOND, frozen
from benchmarks.report import markdown

CONSTANTS = ("energy_uncertainty", "stiffness_uncertainty", "buckling_share")
STARTS = ((0.05, 0.35, 0.2), (0.1, 0.1, 0.1), (0.03, 0.5, 0.1))
QUANTILE = 0.9
HEADER = [
    "", *CONSTANTS, "designs", "distances within", "misses", "announced", f"within {CLOSE:g} %", "announced too",
    "heights within", "loss",
]  # fmt: skip


@dataclass(frozen=True)
class Compared:
    """A comparison with an exact shape, and the sources of the preview's estimate."""

    row: Row
    sources: ErrorSources

    @property
    def height_error_mm(self) -> float:
        """Absolute error; smaller ones than the mesh error of the exact shape count as that."""
        least = 0.01 * PREVIEW_MODEL.mesh_error_percent * self.sources.diameter_mm
        return max(abs(float(np.subtract(*self.row["heights_mm"]))), least)

    def estimates(self, model: PreviewModel) -> tuple[float, float | None]:
        """Of the distance in % of the diameter, and of the height in %."""
        return distance_error_percent(self.sources, model), height_error_percent(self.sources, model)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy.error_model")
    parser.add_argument("folder", type=Path)
    parser.add_argument("frozen_folder", type=Path)
    options = parser.parse_args()
    fitted_to = [
        *comparisons([*designs(), *canopies(), *other_held()], options.folder),
        *comparisons([each for _, each in frozen(SECOND)], options.frozen_folder),
    ]
    judging = list(comparisons([each for half in HALVES for _, each in frozen(half)], options.frozen_folder))
    if not fitted_to:
        parser.error(f"FOLDER: {options.folder} has no exact shapes: run python -m benchmarks.accuracy first")
    best = fitted(fitted_to)
    lines = [
        [name, *(f"{getattr(model, constant):.3f}" for constant in CONSTANTS), *goodness(some, model)]
        for name, some in (("fitted to", fitted_to), ("judging", judging))
        for model in (best, PREVIEW_MODEL)
        if some
    ]
    print(markdown(HEADER, lines))


def comparisons(chosen: Iterable[Design], folder: Path) -> Iterator[Compared]:
    """Those with both exact shapes in the folder and an estimate."""
    for design in chosen:
        if is_solved(design, folder):
            try:
                row = compared(design, folder)
            except LawError:
                continue
            if row["expected_rms_percent"] is not None:
                yield Compared(row, sources_of(row["preview"]))


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


def fitted(some: Sequence[Compared]) -> PreviewModel:
    """The model with the constants that fit comparisons best."""

    def model(values: np.ndarray) -> PreviewModel:
        constants: dict[str, Any] = dict(zip(CONSTANTS, np.abs(values).tolist(), strict=True))
        return replace(PREVIEW_MODEL, **constants)

    options = {"xatol": 1e-4, "fatol": 1e-6}
    found = [
        minimize(lambda values: loss(some, model(values)), start, method="Nelder-Mead", options=options)
        for start in STARTS
    ]
    return model(min(found, key=lambda each: float(each.fun)).x)


def loss(some: Sequence[Compared], model: PreviewModel) -> float:
    """Mean quantile loss of the logarithms of distances and heights over their estimates; inf for no estimate."""
    if model.energy_uncertainty == 0.0:
        return math.inf
    distances, heights = [], []
    for each in some:
        distance, height = each.estimates(model)
        distances.append(math.log(each.row["rms_percent"] / distance))
        if each.sources.height and height:
            heights.append(math.log(100.0 * each.height_error_mm / (each.sources.height.height * height)))
    logarithms = [np.array(values) for values in (distances, heights) if values]
    return sum(float(np.mean(np.maximum(QUANTILE * x, (QUANTILE - 1.0) * x))) for x in logarithms)


def goodness(some: Sequence[Compared], model: PreviewModel) -> list[str]:
    """The columns of `HEADER` after the constants."""
    pairs = [(each.row, *each.estimates(model)) for each in some]
    far, close = [p for p in pairs if missed(p[0])], [p for p in pairs if p[0]["rms_percent"] <= CLOSE]
    heights = [abs(row["height_error_percent"]) <= height for row, _, height in pairs if height is not None]
    return [
        str(len(pairs)), f"{sum(row['rms_percent'] <= distance for row, distance, _ in pairs)}",
        *(cell for group in (far, close) for cell in (str(len(group)), str(sum(p[1] > FAR for p in group)))),
        f"{sum(heights)} of {len(heights)}", f"{loss(some, model):.3f}",
    ]  # fmt: skip


if __name__ == "__main__":
    main()
