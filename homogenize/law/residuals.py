"""How far a law is from cells that its fit has not seen, and what its own cells say about it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.plan import CellTask
from asterism.homogenize.law.table import LawTable


def held_out_errors(table: LawTable, tests: Sequence[tuple[CellTask, Floats | None]]) -> dict[str, Any]:
    """Errors at held-out cells as plain data, in percent, over the stated range of the law.

    Cells that are not scale-separated are counted under "tight", with errors of their own.

    Parameters
    ----------
    tests : the tasks with the stored forms (K,) of their cells; None for a cell without an answer.
    """
    known = [(task, row) for task, row in tests if row is not None]
    plan, without = table.plan, len(tests) - len(known)
    if not known:
        empty = {"count": 0, "without_answer": without, "outside": 0}
        return {**empty, "errors": {}, "tight": {"count": 0, "errors": {}}, "cells": []}
    sizes = np.array([task.sizes for task, _ in known]).reshape(len(known), -1)
    errors = table.errors(sizes, np.array([row for _, row in known]))
    tight = errors.inside & errors.tight
    stated = errors.inside & ~tight
    return {
        "count": int(stated.sum()),
        "without_answer": without,
        "outside": int((~errors.inside).sum()),
        "errors": _summary(table, errors.percent[stated]),
        "tight": {"count": int(tight.sum()), "errors": _summary(table, errors.percent[tight])},
        "cells": [
            {
                **plan.named(sizes[n]),
                "inside": bool(errors.inside[n]),
                "tight": bool(tight[n]),
                "law": {name: float(values[n]) for name, values in errors.law.items()},
                "cell": {name: float(values[n]) for name, values in errors.cell.items()},
                "error_percent": dict(zip(table.error_names, map(float, errors.percent[n]), strict=True)),
            }
            for n in range(len(known))
        ],
    }


def unstable_tubes(samples: Sequence[dict[str, Any]]) -> dict[str, int]:
    """Count of the cells with arms and an answer, and of those whose natural tubes are unstable on 2 x 2 stars."""
    solved = _with_arms(samples)
    return {"count": len(solved), "unstable": sum(min(s["natural_supercell_eigenvalue"]) <= 0.0 for s in solved)}


def broken_symmetry(samples: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Count of the cells with arms and an answer, and the largest `Sample.asymmetry` among them, in percent."""
    solved = _with_arms(samples)
    largest = max((sample.get("asymmetry") or 0.0 for sample in solved), default=0.0)
    return {"count": len(solved), "largest_percent": 100.0 * largest}


def _with_arms(samples: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    return [each["sample"] for each in samples if each["problem"] is None and each["length_mm"] > 0]


def _summary(table: LawTable, percent: Floats) -> dict[str, dict[str, float]]:
    return {
        name: {
            "rms_percent": float(np.sqrt(np.mean(column**2))),
            "median_percent": float(np.median(np.abs(column))),
            "largest_percent": float(np.abs(column).max()),
        }
        for name, column in zip(table.error_names, percent.T, strict=True)
        if len(column)
    }
