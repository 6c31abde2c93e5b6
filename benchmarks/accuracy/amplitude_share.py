"""The share of the amplitudes in the estimated error of a preview, fitted to all comparisons that are kept.

python -m benchmarks.accuracy.amplitude_share

Prints, for each share, how many previews are as near to the exact shape as they estimate, free and supported, how many
misses they announce, and how many of those within 1 % are announced too; the same for heights. The smallest share that
covers nine of ten sheets is chosen. Estimates are computed anew from the amplitudes and forms that benchmarks/results
keeps of each preview.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.uncertainty.distance_error import distance_error_percent
from asterism.previews.uncertainty.height_error import HeightDoubts, height_error_percent
from asterism.previews.uncertainty.other_forms import OtherForm
from benchmarks.accuracy.report import announced, height_announced, height_missed, missed
from benchmarks.report import RESULTS, markdown

SHARES = [round(0.01 * k, 2) for k in range(3, 11)]
COVERED = 0.9  # share of the designs
CLOSE = 1.0  # % of the diameter
SOURCES = ("accuracy.expectation", "accuracy.held")
HEADER = [
    "share", "rms, free", "rms, supported", "misses announced", f"announced within {CLOSE:g} %", "height, all",
    "misses of the height announced", "heights announced that are no misses",
]  # fmt: skip

Row = dict[str, Any]


def main() -> None:
    rows = [row for source in SOURCES for row in _rows(source)]
    print(markdown(HEADER, [line(rows, share) for share in SHARES]))
    print(f"\nSmallest share that covers {COVERED:.0%}: {chosen(rows)}")


def chosen(rows: Sequence[Row]) -> float | None:
    """The smallest of `SHARES` that covers `COVERED` of all sheets; None if none does."""
    for share in SHARES:
        if sum(_is_covered(row | with_share(row, share)) for row in rows) >= COVERED * len(rows):
            return share
    return None


def line(rows: Sequence[Row], share: float) -> list[str]:
    """One share of the table."""
    new = [row | with_share(row, share) for row in rows]
    far, close = [row for row in new if missed(row)], [row for row in new if row["rms_percent"] <= CLOSE]
    high, other = ([row for row in new if height_missed(row) == is_miss] for is_miss in (True, False))
    covered = sum(abs(row["height_error_percent"]) <= row["expected_height_percent"] for row in new)
    return [
        f"{share:.2f}",
        *(f"{sum(map(_is_covered, group))} of {len(group)}" for group in _groups(new)),
        f"{sum(map(announced, far))} of {len(far)}",
        f"{sum(map(announced, close))} of {len(close)}",
        f"{covered} of {len(new)}",
        f"{sum(map(height_announced, high))} of {len(high)}",
        f"{sum(map(height_announced, other))} of {len(other)}",
    ]


def with_share(row: Row, share: float) -> Row:
    """The estimates of a comparison with a share of the amplitudes."""
    shown, model = row["preview"], replace(PREVIEW_MODEL, amplitude_share=share)
    forms = [OtherForm(**{each.name: form[each.name] for each in fields(OtherForm)}) for form in shown["other_forms"]]
    amplitudes = np.array(shown["soft_amplitudes_percent"])
    return {
        "expected_rms_percent": distance_error_percent(amplitudes, forms, shown["contrast_percent"], model),
        "expected_height_percent": height_error_percent(_doubts(row), row["diameter_mm"], model),
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
