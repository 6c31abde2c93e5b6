"""How far a law is from its cells: from held-out ones, and from its own, left out one by one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.law.axes import AXES, named_sizes
from asterism.homogenize.law.hermite_grid import HermiteGrid
from asterism.homogenize.law.law_table import (
    MAX_SEPARATED_CURL,
    QUANTITIES,
    QUANTITY_NAMES,
    LawTable,
    from_stored,
    to_stored,
)
from asterism.homogenize.law.plan import CellTask

# An error is relative to the cell's value, or to this part of the largest value in the table if that is larger. The
# part is larger for quantities that change their sign.
ERROR_FLOORS = {"a12": 0.1, "c3": 0.1}
DEFAULT_ERROR_FLOOR = 0.03


def law_residuals(
    tables: Sequence[LawTable], tests: Sequence[Sequence[tuple[CellTask, Floats | None]]], kind: str
) -> dict[str, Any]:
    """Errors of a law, as plain data: by stretch ("1.35"), then by kind of test ("held_out", "leave_one_out").

    Errors are in percent and cover the stated range of the law. Cells that are not scale-separated
    (`law_table.MAX_SEPARATED_CURL`) are counted under "tight", with errors of their own.

    Parameters
    ----------
    tests : for each table, the held-out tasks with the rows (Q,) of their cells; None for a cell without an answer.
    kind : of the plan. Only the cells of a grid are left out one by one.
    """
    residuals: dict[str, Any] = {}
    for table, pairs in zip(tables, tests, strict=True):
        entry: dict[str, Any] = {"held_out": _held_out(table, pairs)}
        if kind == "grid":
            entry["leave_one_out"] = _leave_one_out(table)
        residuals[f"{table.stretch:g}"] = entry
    return residuals


def mesh_differences(samples: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The cells that were solved on two meshes: their count, and the largest difference of the natural curvature.

    The largest difference, in percent of the larger curvature, comes with the sizes of its star. Without such cells
    the count stands alone.

    Parameters
    ----------
    samples : as in a law's file.
    """
    known = [each for each in samples if each["problem"] is None and each["sample"].get("meshes_apart") is not None]
    if not known:
        return {"count": 0}
    worst = max(known, key=lambda each: each["sample"]["meshes_apart"])
    sizes = {axis.key: worst[axis.key] for axis in AXES}
    return {"count": len(known), "largest_percent": 100.0 * worst["sample"]["meshes_apart"], **sizes}


def unstable_tubes(samples: Sequence[dict[str, Any]]) -> dict[str, int]:
    """Count of the cells with arms and an answer, and of those whose natural tubes are unstable on 2 x 2 stars."""
    solved = [each["sample"] for each in samples if each["problem"] is None and each["length_mm"] > 0]
    return {"count": len(solved), "unstable": sum(not _has_stable_tubes(sample) for sample in solved)}


def broken_symmetry(samples: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Count of the cells with arms and an answer, and the largest `Sample.asymmetry` among them, in percent."""
    solved = [each["sample"] for each in samples if each["problem"] is None and each["length_mm"] > 0]
    largest = max((sample.get("asymmetry") or 0.0 for sample in solved), default=0.0)
    return {"count": len(solved), "largest_percent": 100.0 * largest}


def _has_stable_tubes(sample: dict[str, Any]) -> bool:
    """Whether the natural tubes are minima among all states of 2 x 2 stars."""
    return bool(min(sample["natural_supercell_eigenvalue"]) > 0.0)


def _held_out(table: LawTable, pairs: Sequence[tuple[CellTask, Floats | None]]) -> dict[str, Any]:
    known = [(task, row) for task, row in pairs if row is not None]
    if not known:
        empty = {"count": 0, "without_answer": len(pairs), "outside": 0}
        return {**empty, "errors": {}, "tight": {"count": 0, "errors": {}}, "cells": []}
    sizes = np.array([task.sizes for task, _ in known])
    law, cells = table(*sizes.T), np.array([row for _, row in known])
    values = np.column_stack([law.value[name] for name in QUANTITY_NAMES])
    percent = _error_percent(table, values, cells)
    not_scale_separated = law.inside & (_not_scale_separated(table, cells) | law.not_scale_separated)
    stated = law.inside & ~not_scale_separated
    return {
        "count": int(stated.sum()),
        "without_answer": len(pairs) - len(known),
        "outside": int((~law.inside).sum()),
        "errors": _summary(percent[stated]),
        "tight": {"count": int(not_scale_separated.sum()), "errors": _summary(percent[not_scale_separated])},
        "cells": [
            {
                **named_sizes(sizes[n]),
                "inside": bool(law.inside[n]),
                "tight": bool(not_scale_separated[n]),
                "law": dict(zip(QUANTITY_NAMES, map(float, values[n]), strict=True)),
                "cell": dict(zip(QUANTITY_NAMES, map(float, cells[n]), strict=True)),
                "error_percent": dict(zip(QUANTITY_NAMES, map(float, percent[n]), strict=True)),
            }
            for n in range(len(known))
        ],
    }


def _leave_one_out(table: LawTable) -> dict[str, Any]:
    """Errors at every inner cell of each line of lengths, interpolated from the others on that line.

    This is harder than what the law has to do. Where the law begins with its shortest cells, these are not inner ones.
    """
    lengths = table.axis_nodes[0]
    stored = to_stored(table.node_values, table.units)
    rules = [quantity.rule for quantity in QUANTITIES.values()]
    across = stored.shape[1:-1]
    index = tuple(number.ravel() for number in np.indices(across))
    errors = []
    for i in range(2 if table.min_length_mm else 1, len(lengths) - 1):
        others = np.delete(np.arange(len(lengths)), i)
        grid = HermiteGrid((lengths[others], *(np.arange(float(n)) for n in across)), stored[others], rules)
        interpolated, _ = grid(np.column_stack([np.full(len(index[0]), lengths[i]), *index]))
        cells = table.node_values[(i, *index)]
        usable = table.solved[(i, *index)] & ~_not_scale_separated(table, cells)
        errors.append(_error_percent(table, from_stored(interpolated, table.units), cells)[usable])
    every = np.concatenate(errors) if errors else np.empty((0, len(QUANTITY_NAMES)))
    return {"count": len(every), "errors": _summary(every) if len(every) else {}}


def _error_percent(table: LawTable, values: Floats, cells: Floats) -> Floats:
    """(n, Q) errors of values (n, Q) in percent of the cells' (n, Q), with `ERROR_FLOORS`."""
    stated = table.solved & ~_not_scale_separated(table, table.node_values)
    largest = np.abs(table.node_values[stated]).max(axis=0)
    floor = np.array([ERROR_FLOORS.get(name, DEFAULT_ERROR_FLOOR) for name in QUANTITY_NAMES])
    scale = np.maximum(np.abs(cells), np.maximum(floor * largest, 1e-12))
    return np.asarray(100 * (values - cells) / scale)


def _not_scale_separated(table: LawTable, rows: Floats) -> Bools:
    """(...) whether stars with rows (..., Q) are not scale-separated."""
    return np.asarray(np.abs(rows[..., QUANTITY_NAMES.index("kappa")]) * table.spacing_mm > MAX_SEPARATED_CURL)


def _summary(percent: Floats) -> dict[str, dict[str, float]]:
    return {
        name: {
            "rms_percent": float(np.sqrt(np.mean(column**2))),
            "median_percent": float(np.median(np.abs(column))),
            "largest_percent": float(np.abs(column).max()),
        }
        for name, column in zip(QUANTITY_NAMES, percent.T, strict=True)
        if len(column)
    }
