"""How good the preview's expectation of its height is; `benchmarks.accuracy.expectation` prints it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from asterism.previews.model import PREVIEW_MODEL
from asterism.verification.numbers import MAX_LIKE_DISTANCE_PERCENT
from benchmarks.accuracy.report import height_announced, height_expected, height_missed
from benchmarks.report import markdown

Row = dict[str, Any]

IN_USE = PREVIEW_MODEL.height_softness_share
MAX_SHARE = 10.0  # of the softness, in the fit
NAMES = ["share of the softness"]
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
    lines = [[name, *goodness(rows)] for name, rows in groups.items() if rows]
    numbers = [["in use", f"{IN_USE:.3f}"], ["fitted", f"{fitted(known):.3f}"]]
    numbers.append(["fitted without one", f"{min(fits):.3f} to {max(fits):.3f}"])
    return "\n\n".join([markdown(HEADER, lines), markdown(["", *NAMES], numbers)])


def fitted(rows: Sequence[Row]) -> float:
    """The share that makes the errors of near forms likeliest, if each is normal with what is expected of it."""
    some = [one for one in rows if one["rms_percent"] < MAX_LIKE_DISTANCE_PERCENT]
    parts = np.array([_parts(one) for one in some])
    error = np.array([np.subtract(*one["heights_mm"]) for one in some])

    def unlikely(share: float) -> float:
        spread = np.hypot(parts[:, 0], share * parts[:, 1])
        return float((np.log(spread) + 0.5 * (error / spread) ** 2).sum())

    return float(minimize_scalar(unlikely, bounds=(0.0, MAX_SHARE), method="bounded").x)


def expected(one: Row, share: float) -> float:
    """% of the preview's height."""
    height, (known, soft) = one["preview"]["height_doubts_mm"]["height"], _parts(one)
    return float(100.0 * math.hypot(known, share * soft) / height)


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


def _parts(one: Row) -> tuple[float, float]:
    """mm, the lowest point with the floor, which count in full, and the softness, of which a share counts."""
    doubts, floor = one["preview"]["height_doubts_mm"], 0.01 * PREVIEW_MODEL.floor_percent * one["diameter_mm"]
    return math.hypot(doubts["lowest"], floor), PREVIEW_MODEL.amplitude_share * doubts["softness"]
