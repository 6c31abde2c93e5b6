"""The share of the amplitudes in the estimated error of supported sheets, chosen on the study.

python -m benchmarks.accuracy.supported_share

Prints, for each share, how many of the supported designs are as near to the exact shape, as held, as their preview
estimates. The smallest share that covers nine of ten in the study is chosen. The sheets of `benchmarks.accuracy.held`
stand beside it; they do not choose. Distances are those of benchmarks/results. Previews are computed again; a design is
left out if its preview has another shape than the one that was compared.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np

from asterism.previews.model import PREVIEW_MODEL
from asterism.previews.uncertainty.height_error import HeightDoubts, height_error_percent
from benchmarks.accuracy.finished import restated
from benchmarks.laws import law_of
from benchmarks.report import RESULTS, markdown
from homogenize.law.law import Law
from homogenize.law.law_file import load_law
from pattern.design.design import Design

SHARES = [round(0.01 * k, 2) for k in range(3, 13)]
COVERED = 0.9  # share of the study's supported designs
HEADER = ["share", "rms, study", "rms, few supports", "height, study", "height, few supports"]

Row = dict[str, Any]


def main() -> None:
    law = load_law()
    study, held = (_rows(name, law) for name in ("accuracy", "accuracy.held"))
    lines = [
        [f"{share:.2f}", *(f"{sum(covers(row, share) for row in rows)} of {len(rows)}"
                           for covers in (covers_distance, covers_height) for rows in (study, held))]
        for share in SHARES
    ]  # fmt: skip
    print(markdown(HEADER, lines))
    print(f"\nSmallest share that covers {COVERED:.0%} of the study: {chosen(study)}")


def chosen(rows: Sequence[Row]) -> float | None:
    """The smallest share that covers `COVERED` of the rows; None if none of `SHARES` does."""
    enough = COVERED * len(rows)
    return next((share for share in SHARES if sum(covers_distance(row, share) for row in rows) >= enough), None)


def covers_distance(row: Row, share: float) -> bool:
    """Whether the estimate with a share is at least the distance; the row's estimate has the share in use."""
    amplitude = float(np.linalg.norm(row["preview"]["soft_amplitudes_percent"]))
    more = (share**2 - PREVIEW_MODEL.amplitude_share_supported**2) * amplitude**2
    return bool(row["rms_percent"] ** 2 <= row["expected_rms_percent"] ** 2 + more)


def covers_height(row: Row, share: float) -> bool:
    """Whether the estimate with a share is at least the error of the height."""
    doubts = HeightDoubts(**row["preview"]["height_doubts_mm"])
    expected = height_error_percent(doubts, share)
    return expected is not None and abs(row["height_error_percent"]) <= expected


def _rows(name: str, law: Law) -> list[Row]:
    """The supported designs of a result that have an estimate, with that of a new preview."""
    rows = []
    for row in json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8"))["rows"]:
        design = Design.from_dict(row["design"])
        if not design.pins:
            continue
        new_row = restated(row, design, law_of(design, law))
        if new_row is None:
            print(f"{design.name}: its preview has another shape than the one that was compared", flush=True)
        elif new_row["expected_rms_percent"] is not None and new_row["expected_height_percent"] is not None:
            rows.append(new_row)
    return rows


if __name__ == "__main__":
    main()
