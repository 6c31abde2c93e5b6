"""Tables of comparisons, for the study, the sheets on few supports and the frozen designs alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from benchmarks.accuracy.comparisons import HEIGHT_FAR, Row, announced, missed
from benchmarks.report import markdown, number

CLOSE = 1.0  # % of the diameter: of sheets within it few should carry a warning
TOTALS = [
    "", "designs", "rms, median %", "nine in ten %", "largest %", "after a rigid motion, median %", "same form",
    "misses", "announced", "rms within expected", "height, median %", f"heights within {HEIGHT_FAR:g} %",
    "others announced", "heights within expected", f"rises within {HEIGHT_FAR:g} %", "bumps, median %",
    f"rms within {CLOSE:g} %", "of these with a warning", "exact, two meshes, median %", "nine in ten %",
    "previews closer than that",
]  # fmt: skip
HEADER = [
    "design", "stars", "held", "rms %", "rms mm", "after a rigid motion %", "expected %", "height exact mm",
    "height mm", "height %", "expected height %", "same form", "exact, two meshes %", "exact from", "warnings",
]  # fmt: skip


def section(groups: Mapping[str, Sequence[Row]], *more: str) -> str:
    """Markdown: totals of each group, more paragraphs, and each design of the first group."""
    first = next(iter(groups.values()))
    table = markdown(TOTALS, [[name, *_totals(rows)] for name, rows in groups.items() if rows])
    return "\n\n".join([table, *more, markdown(HEADER, [line(row) for row in first])])


def by_support(rows: Sequence[Row]) -> dict[str, Sequence[Row]]:
    """All, supported and free ones."""
    return {
        "all": rows,
        "supported": [row for row in rows if row["is_held"]],
        "free": [row for row in rows if not row["is_held"]],
    }


def line(row: Row) -> list[str]:
    """One design."""
    return [
        row["name"], str(row["stars"]), "held" if row["is_held"] else "free", f"{row['rms_percent']:.2f}",
        f"{row['rms_mm']:.2f}", f"{row['rms_after_motion_percent']:.2f}", number(row["expected_rms_percent"]),
        *(f"{height:.1f}" for height in row["heights_mm"]), f"{row['height_error_percent']:+.1f}",
        number(row["expected_height_percent"], ".1f"), "yes" if row["same_branch"] else "no",
        number(row["mesh_change_percent"]), row["result_from"], str(len(row["warnings"])),
    ]  # fmt: skip


def _totals(rows: Sequence[Row]) -> list[str]:
    rms, height = np.array([row["rms_percent"] for row in rows]), _known(rows, "height_error_percent")
    rises, bumps = _known(rows, "rise_error_percent"), _known(rows, "relief_error_percent")
    far = [row for row in rows if missed(row)]
    high = [row for row in rows if abs(row["height_error_percent"]) > HEIGHT_FAR]
    close = [row for row in rows if row["rms_percent"] <= CLOSE]
    meshes = [row for row in rows if row["mesh_change_percent"] is not None]
    changes = _known(rows, "mesh_change_percent")
    return [
        str(len(rows)), *(f"{np.quantile(rms, share):.2f}" for share in (0.5, 0.9, 1.0)),
        f"{np.median([row['rms_after_motion_percent'] for row in rows]):.2f}",
        str(sum(bool(row["same_branch"]) for row in rows)), str(len(far)), str(sum(map(announced, far))),
        _covered(rows, "rms_percent", "expected_rms_percent"), f"{np.median(height):.1f}", str(len(rows) - len(high)),
        f"{sum(announced(row, 'expected_height_percent', HEIGHT_FAR) for row in high)} of {len(high)}",
        _covered(rows, "height_error_percent", "expected_height_percent"),
        f"{(rises <= HEIGHT_FAR).sum()} of {len(rises)}", f"{np.median(bumps):.0f}" if len(bumps) else "-",
        str(len(close)), str(sum(bool(row["warnings"]) for row in close)),
        *(f"{np.quantile(changes, share):.2f}" if len(changes) else "-" for share in (0.5, 0.9)),
        f"{sum(row['rms_percent'] < row['mesh_change_percent'] for row in meshes)} of {len(meshes)}",
    ]  # fmt: skip


def _known(rows: Sequence[Row], key: str) -> np.ndarray:
    return np.abs([row[key] for row in rows if row.get(key) is not None])


def _covered(rows: Sequence[Row], error: str, expected: str) -> str:
    known = [row for row in rows if row[expected] is not None]
    return f"{sum(bool(abs(row[error]) <= row[expected]) for row in known)} of {len(known)}"
