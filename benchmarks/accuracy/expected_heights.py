"""How good the preview's expectation of its height is; `benchmarks.accuracy.expectation` prints it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from benchmarks.accuracy.report import height_announced, height_expected, height_missed
from benchmarks.report import markdown

Row = dict[str, Any]

HEADER = [
    "", "designs", "error over expected, median", "nine in ten", "more than twice that", "more than 6 % off",
    "of these expected", "or another form warned of", "within 6 %",
    "of these expected to be off by more", "or another form warned of",
]  # fmt: skip


def section(groups: Mapping[str, Sequence[Row]]) -> str:
    """Markdown: how good it is on rows, in groups."""
    return markdown(HEADER, [[name, *goodness(rows)] for name, rows in groups.items() if rows])


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
