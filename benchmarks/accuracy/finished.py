"""Finished comparisons: kept in a folder, and used again while the preview keeps its shape.

python -m benchmarks.accuracy.finished FOLDER

puts the comparisons of benchmarks/results into FOLDER, where there are none yet; supported sheets only if they were
compared as held. Then `--kept` of the other commands computes an exact shape only for designs that have none.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.files import plain
from asterism.previews.run import preview
from asterism.results.files import write_file
from asterism.shape.shape import Shape
from benchmarks.report import RESULTS

Row = dict[str, Any]

SOURCES = ("accuracy", "accuracy.held", "accuracy.expectation")
# relative difference of height, extent and energy up to which two previews have one shape: processors differ by less
MAX_SHAPE_CHANGE = 1e-6
# the row's keys that say what the preview states of itself
STATED = ("expected_rms_percent", "expected_height_percent", "warnings")


def row_path(folder: Path, design: Design, starts: bool) -> Path:
    """Where the finished comparison of a design is kept."""
    return folder / design.name / f"{'whole' if starts else 'quick'}.json"


def read_row(path: Path, design: Design) -> Row | None:
    """The comparison in a file; None if there is none, or it is of another design."""
    if not path.exists():
        return None
    row = json.loads(path.read_text(encoding="utf-8"))
    return dict(row) if row["design"] == design.to_dict() else None


def write_row(path: Path, row: Row) -> None:
    """Write a comparison, with its folder."""
    write_file(path, json.dumps(plain(row), indent=1) + "\n")


def restated(row: Row, design: Design, law: Law) -> Row | None:
    """The row with estimates and warnings of a new preview; None if the new preview has another shape."""
    shown = preview(design, law)
    return with_statements(row, shown) if is_same_shape(row["preview"], shown.summary) else None


def with_statements(row: Row, shown: Shape) -> Row:
    """The row with what a preview states of itself."""
    summary = {key: value for key, value in shown.summary.items() if key != "design"}
    stated = {key: summary.get(key) for key in STATED}
    return row | stated | {"preview": summary}


def is_same_shape(first: Any, second: Any) -> bool:
    """Whether the summaries of two previews of a design are of one shape."""
    return np.allclose(_size(first), _size(second), rtol=MAX_SHAPE_CHANGE, atol=0.0)


def _size(summary: Any) -> list[float]:
    return [summary["energy_n_mm"], summary["height_mm"], *summary["extent_mm"]]


def as_held(row: Row) -> Row | None:
    """A committed row with the keys of a comparison as held; None if it compared a supported sheet in another way."""
    if "rms_after_motion_percent" in row:
        return row
    if row["design"].get("pins"):
        return None
    # all rigid motions of a free sheet are free, so that both distances are one
    largest, rms = (0.01 * row["diameter_mm"] * row[key] for key in ("max_percent", "rms_percent"))
    return row | {"rms_after_motion_percent": row["rms_percent"], "rms_mm": rms, "max_mm": largest, "free_motions": 6}


def fill(folder: Path, source: Path = RESULTS) -> int:
    """Put the comparisons of the results into a folder; the number of those that it did not have."""
    count = 0
    for name in SOURCES:
        content = json.loads((source / f"{name}.json").read_text(encoding="utf-8"))
        for row in filter(None, map(as_held, content["rows"])):
            path = row_path(folder, Design.from_dict(row["design"]), starts=False)
            if not path.exists():
                write_row(path, row)
                count += 1
    return count


if __name__ == "__main__":
    print(f"{fill(Path(sys.argv[1]))} comparisons")
