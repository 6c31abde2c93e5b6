"""How good the preview's expectation of its height is; `benchmarks.accuracy.expectation` prints it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import minimize

from asterism.previews.model import PREVIEW_MODEL
from asterism.verification.numbers import MAX_LIKE_DISTANCE_PERCENT
from benchmarks.accuracy.report import height_announced, height_expected, height_missed
from benchmarks.report import markdown

Row = dict[str, Any]

IN_USE = (PREVIEW_MODEL.height_softness_share, PREVIEW_MODEL.height_share)
NAMES = ["share of the softness", "share of the height"]
HEADER = [
    "", "designs", "error over expected, median", "nine in ten", "more than twice that", "more than 6 % off",
    "of these expected", "or another form warned of", "within 6 %",
    "of these expected to be off by more", "or another form warned of",
]  # fmt: skip
PREDICTED, AFTERWARDS = "each of these, predicted by a fit to the others", "designs drawn afterwards, never fitted to"


def section(groups: dict[str, Sequence[Row]], unseen: Sequence[Row], others: dict[str, Sequence[Row]]) -> str:
    """Markdown: how good it is on rows it was fitted to, in groups, and on others, and the fits."""
    known = [one for rows in groups.values() for one in rows if one["expected_height_percent"] is not None]
    fits = [fitted([other for other in known if other is not one]) for one in known]
    again = [one | {"expected_height_percent": expected(one, fit)} for one, fit in zip(known, fits, strict=True)]
    groups = groups | {PREDICTED: again, AFTERWARDS: unseen} | others
    lines = [[name, *goodness(rows)] for name, rows in groups.items()]
    numbers = [["in use", *_three(IN_USE)], ["fitted", *_three(fitted(known))]]
    ranges = zip(_three(np.min(fits, axis=0)), _three(np.max(fits, axis=0)), strict=True)
    numbers.append(["fitted without one", *(f"{low} to {high}" for low, high in ranges)])
    return "\n\n".join([markdown(HEADER, lines), markdown(["", *NAMES], numbers)])


def fitted(rows: Sequence[Row]) -> tuple[float, ...]:
    """The constants that make the errors of near forms likeliest, if each is normal with what is expected of it."""
    some = [one for one in rows if one["rms_percent"] < MAX_LIKE_DISTANCE_PERCENT]
    parts = np.array([_parts(one) for one in some])
    error = np.array([np.subtract(*one["heights_mm"]) for one in some])

    def unlikely(w: np.ndarray) -> float:
        spread = np.linalg.norm(np.append(1.0, w) * parts, axis=1)
        return float((np.log(spread) + 0.5 * (error / spread) ** 2).sum())

    best = minimize(unlikely, IN_USE, method="Nelder-Mead", options={"maxiter": 4000, "maxfev": 4000}).x
    return tuple(float(x) for x in np.abs(best))


def expected(one: Row, fit: Sequence[float]) -> float:
    """% of the preview's height."""
    height = one["preview"]["height_doubts_mm"]["height"]
    return float(100.0 * np.linalg.norm(np.multiply([1.0, *fit], _parts(one))) / height)


def goodness(rows: Sequence[Row]) -> list[str]:
    rows = [one for one in rows if one["expected_height_percent"] is not None]
    ratio = np.array([abs(one["height_error_percent"]) / one["expected_height_percent"] for one in rows])
    split = [[one for one in rows if height_missed(one) == far] for far in (True, False)]
    counts = [[len(some), sum(map(height_expected, some)), sum(map(height_announced, some))] for some in split]
    return [
        str(len(rows)),
        f"{np.median(ratio):.2f}",
        f"{np.quantile(ratio, 0.9):.2f}",
        str((ratio > 2.0).sum()),
        *(str(count) for line in counts for count in line),
    ]


def _parts(one: Row) -> list[float]:
    """mm, the lowest point, which counts in full, and what each constant is a part of."""
    doubts = one["preview"]["height_doubts_mm"]
    return [doubts["lowest"], PREVIEW_MODEL.amplitude_share * doubts["softness"], doubts["height"]]


def _three(numbers: Sequence[float]) -> list[str]:
    return [f"{x:.3f}" for x in numbers]
