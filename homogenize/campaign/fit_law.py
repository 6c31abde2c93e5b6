"""From the samples of a campaign to the tables of a law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.cell.motif_responses import completed_by_rods
from asterism.homogenize.cell.point_group import MIN_RESOLVED_CURL, averaged_directions
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.anisotropy import (
    VOIGT_ENTRIES,
    isotropic_constants,
    sample_anisotropy,
    voigt_matrices,
)
from asterism.homogenize.law.hermite_grid import HermiteGrid
from asterism.homogenize.law.law import LawTable
from asterism.homogenize.law.law_file import law_of_tables
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import CellTask, LawPlan, SampleRecord, Stretch, stretch_text
from asterism.homogenize.law.star_law import QUANTITIES, QUANTITY_NAMES, StarLaw, anisotropy_size, to_stored
from asterism.homogenize.law.tensor_forms import TO_VOIGT, SheetTensors, stored_tensors


def held_out_errors(table: LawTable, tests: Sequence[tuple[CellTask, Floats | None]]) -> dict[str, Any]:
    """Errors at held-out cells as plain data, in percent, over the stated range of the law.

    Cells that are not scale-separated are counted under "tight", with errors of their own.
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


def fit_law(plan: LawPlan, records: Sequence[SampleRecord], made: dict[str, Any] | None = None) -> StarLaw | MotifLaw:
    """The law of a campaign. The same records give the same numbers.

    Raises `CampaignError` if too many cells have no answer.

    Parameters
    ----------
    records : of the plan's tasks, or of some of them.
    made : versions, command, machine and seconds, for the law's file.
    """
    cells = {record.task: (_motif_cell if plan.is_motif else _star_cell)(plan, record) for record in records}
    tables = [
        _table(plan, stretch, cells, {record.task: record.label for record in records}) for stretch in plan.stretches
    ]
    samples = [_record_data(plan, record, cells[record.task].problem) for record in records]
    law = law_of_tables(plan, tables, samples, {}, made or {})
    for table in law.tables:
        tests = [
            (task, cell.row if cell.problem is None else None)
            for task, cell in cells.items()
            if task.held_out and task.stretch == table.stretch
        ]
        law.residuals[stretch_text(table.stretch)] = {"held_out": held_out_errors(table, tests)}
    return law


@dataclass(frozen=True)
class _Cell:
    """Stored forms (K,) of a cell, None without an answer, and why it has no law, None if it has one."""

    row: Floats | None
    problem: str | None


def _table(
    plan: LawPlan, stretch: Stretch, cells: Mapping[CellTask, _Cell], labels: Mapping[CellTask, str]
) -> tuple[Floats, Bools]:
    """Stored forms (n1, ..., nA, K) and solved nodes (n1, ..., nA) at one stretch."""
    own = {task: cell for task, cell in cells.items() if task.stretch == stretch and not task.held_out}
    by_sizes = {task.sizes: cell for task, cell in own.items()}
    failed = [f"{labels[task]}: {cell.problem}" for task, cell in own.items() if cell.problem is not None]
    if plan.is_motif:
        if len(failed) == len(own):
            raise CampaignError(failed[0])
    else:
        bare = next((cell for task, cell in own.items() if task.is_bare), _Cell(None, "not solved"))
        if bare.row is None:
            raise CampaignError(f"the bare fabric at stretch {stretch_text(stretch)} has no answer: {bare.problem}")
        if len(own) == len(failed) + 1 or 2 * (len(own) - 1 - len(failed)) < len(own) - 1:
            problem = f"fewer than half of the cells at stretch {stretch_text(stretch)} have an answer"
            raise CampaignError(f"{problem}; the first: {failed[0]}")
        by_sizes |= {(0.0, *others): bare for others in product(*(nodes.tolist() for nodes in plan.axis_nodes[1:]))}
    columns = next(cell.row for cell in own.values() if cell.row is not None).shape
    nothing = _Cell(np.full(columns, np.nan), "not solved")
    grid = [by_sizes.get(sizes, nothing) for sizes in product(*(nodes.tolist() for nodes in plan.axis_nodes))]
    shape = tuple(len(nodes) for nodes in plan.axis_nodes)
    stored = np.array([nothing.row if cell.row is None else cell.row for cell in grid]).reshape(*shape, -1)
    solved = np.array([cell.problem is None for cell in grid]).reshape(shape)
    coordinates = [size.axis.coordinate(nodes) for size, nodes in zip(plan.sizes, plan.axis_nodes, strict=True)]
    return fill_failed_rows(coordinates, stored, has_bare=not plan.is_motif), solved


def fill_failed_rows(coordinates: Sequence[Floats], stored: Floats, has_bare: bool = False) -> Floats:
    """Rows (n1, ..., nA, K) in which those without numbers are filled in, so that all nodes have slopes.

    Between answers on a line along the first axis they come from these; beyond the last ones, and on lines without
    answers, they go on in a straight line, along one axis after the other. These nodes lie outside the range of the
    law. With `has_bare` the first nodes of the first axis are bare fabric, which alone says nothing about stars.
    """
    whole = stored.copy()
    for axis, places in enumerate(coordinates):
        rows = np.moveaxis(whole, axis, 0)
        there = np.asarray(np.isfinite(rows).all(axis=-1))
        for across in np.ndindex(there.shape[1:]):
            fine = there[(slice(None), *across)]
            is_star = fine[1:] if has_bare and axis == 0 else fine
            if is_star.any() and not fine.all():
                rows[(~fine, *across)] = _along(places[fine], rows[(fine, *across)], places[~fine])
    return whole


def _along(places: Floats, rows: Floats, asked: Floats) -> Floats:
    """Rows at places of a line: monotone between the known ones, and straight beyond the first and the last."""
    if len(places) == 1:
        return np.repeat(rows, len(asked), axis=0)
    inner = np.clip(asked, places[0], places[-1])
    out = HermiteGrid([places], rows, ["monotone"] * rows.shape[1])(inner[:, None])
    for two, beyond in (((0, 1), asked < places[0]), ((-1, -2), asked > places[-1])):
        end, next_one = two
        slope = (rows[end] - rows[next_one]) / (places[end] - places[next_one])
        out[beyond] = rows[end] + (asked[beyond] - places[end])[:, None] * slope
    return out


def sample_quantities(sample: dict[str, Any], stretch: Stretch) -> Floats:
    """(Q,) the quantities `star_law.QUANTITY_NAMES` of one sample, plain data of `Sample`.

    With threefold symmetry, means over directions are those of 0 and 30 degrees, where a sixfold function has its
    extremes. Otherwise they are those of all six directions. The membrane constants are those of the isotropic tensor
    nearest to the mean of the natural tubes.
    """
    chosen = averaged_directions(sample["natural_curvature"])
    ends = {
        name: np.array(sample[name], dtype=float)[chosen]
        for name in ("natural_curvature", "natural_hoop", "natural_axial", "natural_membrane", "bending")
    }
    a11, a12 = isotropic_constants(ends["natural_membrane"].mean(axis=0))
    offset = sample["natural_centre_offset_mm"]
    curled = abs(ends["natural_curvature"].mean()) * sample["spacing_mm"] > MIN_RESOLVED_CURL
    bare = sample["length_mm"] == 0.0
    released = 1.0 / float(np.sqrt(np.prod(np.broadcast_to(stretch, 2))))
    quantities = {
        "lam": released if bare else sample["lam"],
        "lam_n": released if bare else float(np.sqrt(ends["natural_hoop"] * ends["natural_axial"]).mean()),
        "kappa": 0.0 if bare else float(ends["natural_curvature"].mean()),
        "bending": float(ends["bending"].mean()),
        "a11": a11,
        "a12": a12,
        "c3": float(np.array(sample["sixfold"], dtype=float)) if curled else 0.0,
        "offset_mm": 0.0 if bare or offset is None else float(np.mean(np.array(offset, dtype=float)[chosen])),
    }
    return np.array([quantities[name] for name in QUANTITY_NAMES])


def _star_cell(plan: LawPlan, record: SampleRecord) -> _Cell:
    """Quantities, differences between directions and corrugation of a star's cell, in their interpolated forms."""
    sample = record.sample
    if record.failed is not None or sample is None:
        return _Cell(None, record.failed or "no answer")
    bump = float(np.array(sample["natural_bump_mm"], dtype=float).min())
    if sample["length_mm"] > 0 and not bump > 0:
        return _Cell(None, f"the star is not up: bump {bump:.3g} mm")
    quantities = sample_quantities(sample, record.task.stretch)
    for name, value in zip(QUANTITY_NAMES, quantities, strict=True):
        if not np.isfinite(value) or (QUANTITIES[name].form == "log" and value <= 0):
            return _Cell(None, f"{name} = {value:.3g} is no answer")
    lattice, bare = plan.design.lattice, record.task.is_bare
    columns = anisotropy_size(plan.design)
    is_alike = not columns or (bare and not plan.design.fabric.is_directional)
    anisotropy = np.zeros(columns) if is_alike else sample_anisotropy(sample)
    corrugation = np.array(sample["relief"], dtype=float).ravel()
    stored = to_stored(quantities, lattice.spacing_mm)
    return _Cell(np.concatenate([stored, anisotropy, np.where(bare, 0.0, corrugation)]), None)


def _motif_cell(plan: LawPlan, record: SampleRecord) -> _Cell:
    """The tensors of a motif's cell, also of one without a law: its answer continues those of its neighbours."""
    if record.sample is None or record.sample["failed_directions"]:
        return _Cell(None, record.failed or "no answer")
    return _Cell(stored_tensors(motif_tensors(record.sample))[0], record.failed)


def motif_tensors(sample: dict[str, Any]) -> SheetTensors:
    """The tensors (n = 1) of plain data of `MotifResponses`: of the flat cell, and the bending of its natural tubes."""
    stiffness = np.zeros((6, 6))
    deformation = np.array(sample["deformation"])
    stiffness[:3, :3] = sample["membrane"]
    stiffness[3:, 3:], moment = _bending_of_tubes(sample)
    metric = deformation @ deformation
    # plastic outside: edges go down
    curvature = -np.linalg.solve(stiffness[3:, 3:], moment) / TO_VOIGT
    return SheetTensors(np.array([[metric[0, 0], metric[1, 1], metric[0, 1]]]), stiffness[None], curvature[None])


def _bending_of_tubes(sample: dict[str, Any]) -> tuple[Floats, Floats]:
    """Q (3, 3) N mm and m (3,) N, in curvatures K of the print: the energy `K . Q K/2 - m . K` nearest to the tubes.

    Tubes leave Q12 open up to Q33 (`rod_bending`): the mean of Q12 over all axes is that of the rods.
    """
    angle, hoop, curvature, bending = (
        np.array([tube[name] for tube in sample["directions"]])
        for name in ("direction_rad", "hoop", "curvature", "bending")
    )
    along = np.stack([np.cos(angle) ** 2, np.sin(angle) ** 2, np.sin(2.0 * angle)], axis=-1)
    curvature, bending = curvature * hoop**2, bending / hoop**4
    pairs = np.array([along[:, i] * along[:, j] * (1.0 if i == j else 2.0) for i, j in VOIGT_ENTRIES]).T
    of_tubes = voigt_matrices(np.linalg.lstsq(pairs, bending, rcond=None)[0])
    sizes, axes = np.linalg.eigh(completed_by_rods(of_tubes, np.array(sample["rods"])))
    q = (axes * np.maximum(sizes, 0.01 * sizes.max())) @ axes.T  # no stiffness is zero
    moment = np.linalg.lstsq(along, bending * curvature, rcond=None)[0]
    return q, moment


def _record_data(plan: LawPlan, record: SampleRecord, problem: str | None) -> dict[str, Any]:
    """A record as plain data for the law's file."""
    return {
        "stretch": record.task.stretch,
        "held_out": record.task.held_out,
        **plan.named(record.task.sizes),
        "problem": problem,
        "sample": record.sample,
    }
