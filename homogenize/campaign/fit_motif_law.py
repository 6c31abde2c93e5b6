"""From the samples of a campaign to the law of a motif."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.campaign.motif_campaign import MotifRecord
from asterism.homogenize.campaign.motif_sample import motif_tensors, responses_from_data
from asterism.homogenize.errors import CampaignError
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_plan import MotifPlan
from asterism.homogenize.law.motif_table import MotifTable, held_out_errors
from asterism.homogenize.law.tensor_forms import STORED_SIZE, SheetTensors, stored_tensors


def fit_motif_law(plan: MotifPlan, records: Sequence[MotifRecord], made: dict[str, Any] | None = None) -> MotifLaw:
    """The law of a campaign. The same records give the same numbers.

    Parameters
    ----------
    records : in the order of `plan.tasks()`.
    made : versions, command, machine and seconds, for the law's file.

    Raises
    ------
    CampaignError
        No part of the range has a law; the message gives the reason of the first cell.
    """
    nodes = tuple(np.array(size.nodes) for size in plan.sizes)
    shape = tuple(len(each) for each in nodes)
    fitted = [record for record in records if not record.task.held_out]
    tests = [record for record in records if record.task.held_out and record.failed is None]
    stored = np.full((len(fitted), STORED_SIZE), np.nan)
    for row, record in enumerate(fitted):
        if (tensors := _tensors(record)) is not None:
            stored[row] = stored_tensors(tensors)[0]
    solved = np.array([record.failed is None for record in fitted])
    if not solved.any():
        raise CampaignError(f"{fitted[0].label}: {fitted[0].failed}")
    whole = _filled(np.array([record.task.sizes for record in fitted]).reshape(len(fitted), -1), stored)
    table = MotifTable(nodes, whole.reshape(*shape, STORED_SIZE), solved.reshape(shape))
    if not table.has_range:
        failed = next(record for record in fitted if record.failed is not None)
        raise CampaignError(
            f"no part of the range has a law; the first cell without one, {failed.label}: {failed.failed}"
        )
    cells = [each for each in map(_tensors, tests) if each is not None]
    sizes = np.array([record.task.sizes for record in tests]).reshape(len(tests), len(nodes))
    residuals = {"held_out": held_out_errors(table, sizes, _joined(cells))}
    return MotifLaw(plan, table, [_data(record) for record in records], residuals, made or {})


def _tensors(record: MotifRecord) -> SheetTensors | None:
    """The tensors of a cell, also of one without a law: its answer continues those of its neighbours."""
    if record.sample is None or record.sample["failed"]:
        return None
    return motif_tensors(responses_from_data(record.sample))


def _joined(cells: list[SheetTensors]) -> SheetTensors:
    if not cells:
        return SheetTensors(np.empty((0, 3)), np.empty((0, 6, 6)), np.empty((0, 3)))
    parts = [np.concatenate([getattr(each, name) for each in cells]) for name in ("metric", "stiffness", "curvature")]
    return SheetTensors(*parts)


def _filled(sizes: Floats, stored: Floats) -> Floats:
    """Rows (n, 18) in which cells without an answer have that of the nearest sizes (n, A)."""
    known: Bools = np.asarray(np.isfinite(stored).all(axis=1))
    out = stored.copy()
    places = np.log(sizes)
    for row in np.flatnonzero(~known):
        distances = np.linalg.norm(places[known] - places[row], axis=1)
        out[row] = stored[known][int(np.argmin(distances))]
    return out


def _data(record: MotifRecord) -> dict[str, Any]:
    return {
        "sizes": list(record.task.sizes),
        "held_out": record.task.held_out,
        "problem": record.failed,
        "seconds": record.seconds,
        "sample": record.sample,
    }
