"""The share of the amplitudes in the estimated error of a preview, fitted to all comparisons that are kept.

python -m benchmarks.accuracy.amplitude_share

Prints, for each share, how many previews are as near to the exact shape as they estimate, free and supported, how many
misses they announce, and how many of those within 1 % are announced too; the same for heights. The smallest share that
covers nine of ten free and nine of ten supported sheets is chosen. The first line counts the estimates as they stand in
benchmarks/results, from which everything is computed: until these are made again, by four shares (free sheets without
symmetry 0.04, with a mirror alone 0.06, with a rotation 0.03, supported 0.08).
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.uncertainty.height_error import HeightDoubts, height_error_percent
from benchmarks.accuracy.report import announced, height_announced, height_missed, missed
from benchmarks.report import RESULTS, markdown

SHARES = [round(0.01 * k, 2) for k in range(3, 11)]
COVERED = 0.9  # share of the designs of a group
CLOSE = 1.0  # % of the diameter
SOURCES = ("accuracy.expectation", "accuracy.held")
# share that the estimate of a comparison contains if the comparison does not name it
UNNAMED_SHARE = 0.08
HEADER = [
    "share", "rms, free", "rms, supported", "misses announced", f"announced within {CLOSE:g} %", "height, all",
    "misses of the height announced", "heights announced that are no misses",
]  # fmt: skip

Row = dict[str, Any]


def main() -> None:
    rows = [row for source in SOURCES for row in _rows(source)]
    print(markdown(HEADER, [line(rows, None), *(line(rows, share) for share in SHARES)]))
    print(f"\nSmallest share that covers {COVERED:.0%} of both groups: {chosen(rows)}")


def chosen(rows: Sequence[Row]) -> float | None:
    """The smallest of `SHARES` that covers `COVERED` of free and of supported sheets; None if none does."""
    for share in SHARES:
        groups = _groups([row | with_share(row, share) for row in rows])
        if all(sum(map(_is_covered, group)) >= COVERED * len(group) for group in groups):
            return share
    return None


def line(rows: Sequence[Row], share: float | None) -> list[str]:
    """One share of the table; None: the estimates as they are."""
    new = [row if share is None else row | with_share(row, share) for row in rows]
    far, close = [row for row in new if missed(row)], [row for row in new if row["rms_percent"] <= CLOSE]
    high, other = ([row for row in new if height_missed(row) == is_miss] for is_miss in (True, False))
    covered = sum(abs(row["height_error_percent"]) <= row["expected_height_percent"] for row in new)
    return [
        "as they are" if share is None else f"{share:.2f}",
        *(f"{sum(map(_is_covered, group))} of {len(group)}" for group in _groups(new)),
        f"{sum(map(announced, far))} of {len(far)}",
        f"{sum(map(announced, close))} of {len(close)}",
        f"{covered} of {len(new)}",
        f"{sum(map(height_announced, high))} of {len(high)}",
        f"{sum(map(height_announced, other))} of {len(other)}",
    ]


def with_share(row: Row, share: float) -> Row:
    """The estimates of a comparison with a share of the amplitudes."""
    amplitude = float(np.linalg.norm(row["preview"]["soft_amplitudes_percent"]))
    more = (share**2 - row.get("share", UNNAMED_SHARE) ** 2) * amplitude**2
    model = replace(PREVIEW_MODEL, amplitude_share=share)
    return {
        "expected_rms_percent": math.sqrt(max(row["expected_rms_percent"] ** 2 + more, model.floor_percent**2)),
        "expected_height_percent": height_error_percent(_doubts(row), model),
    }


def _doubts(row: Row) -> HeightDoubts:
    names = [each.name for each in fields(HeightDoubts)]
    return HeightDoubts(**{name: row["preview"]["height_doubts_mm"][name] for name in names})


def _is_covered(row: Row) -> bool:
    return bool(row["rms_percent"] <= row["expected_rms_percent"])


def _groups(rows: Sequence[Row]) -> tuple[list[Row], list[Row]]:
    """Free and supported sheets."""
    free = [row for row in rows if not row["design"].get("pins")]
    return free, [row for row in rows if row["design"].get("pins")]


def _rows(name: str) -> list[Row]:
    """The comparisons of a result that have both estimates."""
    rows = json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8"))["rows"]
    return [row for row in rows if row["expected_rms_percent"] is not None and row["expected_height_percent"]]


if __name__ == "__main__":
    main()
