"""How far a law is from cells: those it was not made of, and its own, left out one by one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from homogenize.law.hermite_grid import Bools, Floats, HermiteGrid
from homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITIES, QUANTITY_NAMES, LawTable, from_stored, to_stored
from homogenize.law.plan import CellTask

# relative errors are of the cell's value, or of this part of the table's largest where it is smaller: little for what
# has one sign, more for what changes it
ERROR_FLOORS = {"a12": 0.1, "c3": 0.1}
DEFAULT_ERROR_FLOOR = 0.03


def law_residuals(
    tables: Sequence[LawTable], tests: Sequence[Sequence[tuple[CellTask, Floats | None]]], kind: str
) -> dict[str, Any]:
    """Per stretch, and per kind of test, the law's and the cells' values and the errors' summary.

    The errors are those of the stated range. Cells that curl tighter (`TIGHT`) are counted, with errors of their own.

    Parameters
    ----------
    tests : per table the held-out tasks with the rows (Q,) of their cells, None where there is no answer.
    kind : of the plan; a cell of a grid is left out on its line of lengths.
    """
    found: dict[str, Any] = {}
    for table, pairs in zip(tables, tests, strict=True):
        entry: dict[str, Any] = {"held_out": _held_out(table, pairs)}
        if kind == "grid":
            entry["leave_one_out"] = _leave_one_out(table)
        found[f"{table.stretch:g}"] = entry
    return found


def mesh_differences(samples: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Of a law's cells that were solved on two meshes: how many, and by what their curvatures differ at most, percent.

    `samples` as in a law's file. Without cells that differ there is no largest one.
    """
    known = [each for each in samples if each["problem"] is None and each["sample"].get("meshes_apart") is not None]
    if not known:
        return {"count": 0}
    worst = max(known, key=lambda each: each["sample"]["meshes_apart"])
    sizes = {name: worst[name] for name in ("length_mm", "thickness_mm", "width_mm")}
    return {"count": len(known), "largest_percent": 100.0 * worst["sample"]["meshes_apart"], **sizes}


def unstable_tubes(samples: Sequence[dict[str, Any]]) -> dict[str, int]:
    """Of a law's cells with arms: how many have an answer, and how many of these would leave their natural tubes."""
    found = [each["sample"] for each in samples if each["problem"] is None and each["length_mm"] > 0]
    return {"count": len(found), "unstable": sum(not _stable_tubes(sample) for sample in found)}


def _stable_tubes(sample: dict[str, Any]) -> bool:
    """Its natural tubes are minima among all states of 2 x 2 stars."""
    return min(sample["natural_supercell_eigenvalue"]) > 0.0


def _held_out(table: LawTable, pairs: Sequence[tuple[CellTask, Floats | None]]) -> dict[str, Any]:
    known = [(task, row) for task, row in pairs if row is not None]
    if not known:
        none = {"count": 0, "without_answer": len(pairs), "outside": 0}
        return {**none, "errors": {}, "tight": {"count": 0, "errors": {}}, "cells": []}
    sizes = np.array([[task.length_mm, task.thickness_mm, task.width_mm] for task, _ in known])
    law, cells = table(*sizes.T), np.array([row for _, row in known])
    values = np.column_stack([law.value[name] for name in QUANTITY_NAMES])
    relative = _relative(table, values, cells)
    tight = law.inside & (_tight(table, cells) | law.tight)
    stated = law.inside & ~tight
    return {
        "count": int(stated.sum()),
        "without_answer": len(pairs) - len(known),
        "outside": int((~law.inside).sum()),
        "errors": _summary(relative[stated]),
        "tight": {"count": int(tight.sum()), "errors": _summary(relative[tight])},
        "cells": [
            {
                **dict(zip(("length_mm", "thickness_mm", "width_mm"), map(float, sizes[n]), strict=True)),
                "inside": bool(law.inside[n]),
                "tight": bool(tight[n]),
                "law": dict(zip(QUANTITY_NAMES, map(float, values[n]), strict=True)),
                "cell": dict(zip(QUANTITY_NAMES, map(float, cells[n]), strict=True)),
                "error_percent": dict(zip(QUANTITY_NAMES, map(float, relative[n]), strict=True)),
            }
            for n in range(len(known))
        ],
    }


def _leave_one_out(table: LawTable) -> dict[str, Any]:
    """Every inner cell of a line of lengths, from the others on it: harder than the law's own task.

    The first cells are not inner ones where the law begins with them.
    """
    lengths = table.axes[0]
    stored = to_stored(table.nodes, table.units)
    rules = [quantity.rule for quantity in QUANTITIES.values()]
    errors = []
    for i in range(2 if table.least_length_mm else 1, len(lengths) - 1):
        others = np.delete(np.arange(len(lengths)), i)
        across = tuple(np.arange(float(n)) for n in stored.shape[1:3])
        grid = HermiteGrid((lengths[others], *across), stored[others], rules)
        j, k = (index.ravel() for index in np.indices(stored.shape[1:3]))
        guess, _ = grid(np.column_stack([np.full(len(j), lengths[i]), j, k]))
        fine = table.good[i, j, k] & ~_tight(table, table.nodes[i, j, k])
        errors.append(_relative(table, from_stored(guess, table.units), table.nodes[i, j, k])[fine])
    every = np.concatenate(errors) if errors else np.empty((0, len(QUANTITY_NAMES)))
    return {"count": len(every), "errors": _summary(every) if len(every) else {}}


def _relative(table: LawTable, values: Floats, cells: Floats) -> Floats:
    """(n, Q) percent."""
    largest = np.abs(table.nodes[table.good & ~_tight(table, table.nodes)]).max(axis=0)
    floor = np.array([ERROR_FLOORS.get(name, DEFAULT_ERROR_FLOOR) for name in QUANTITY_NAMES])
    scale = np.maximum(np.abs(cells), np.maximum(floor * largest, 1e-12))
    return 100 * (values - cells) / scale


def _tight(table: LawTable, rows: Floats) -> Bools:
    """(...) of rows (..., Q)."""
    return np.abs(rows[..., QUANTITY_NAMES.index("kappa")]) * table.spacing_mm > MAX_SEPARATED_CURL


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
