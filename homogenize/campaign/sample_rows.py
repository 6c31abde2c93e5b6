"""The numbers that a law takes from the sample of one unit cell, and the reasons to reject the sample."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.campaign.campaign import SampleRecord
from asterism.homogenize.cell.effective_stiffness import isotropic_constants
from asterism.homogenize.cell.tube_directions import MIN_RESOLVED_CURL, averaged_directions
from asterism.homogenize.law.anisotropy import sample_anisotropy
from asterism.homogenize.law.axes import named_sizes
from asterism.homogenize.law.law_table import QUANTITIES, QUANTITY_NAMES


def sample_quantities(sample: dict[str, Any], stretch: float) -> Floats:
    """(Q,) the quantities `law_table.QUANTITY_NAMES` of one sample.

    With threefold symmetry, means over directions are those of 0 and 30 degrees, where a sixfold function has its
    extremes. Otherwise they are those of all six directions. The membrane constants are those of the isotropic tensor
    nearest to the mean of the natural tubes.

    Parameters
    ----------
    sample : plain data of `homogenize.cell.sample.Sample`.
    stretch : of the fabric.
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
    quantities = {
        "lam": 1.0 / stretch if bare else sample["lam"],
        "lam_n": 1.0 / stretch if bare else float(np.sqrt(ends["natural_hoop"] * ends["natural_axial"]).mean()),
        "kappa": 0.0 if bare else float(ends["natural_curvature"].mean()),
        "bending": float(ends["bending"].mean()),
        "a11": a11,
        "a12": a12,
        "c3": float(np.array(sample["sixfold"], dtype=float)) if curled else 0.0,
        "offset_mm": 0.0 if bare or offset is None else float(np.mean(np.array(offset, dtype=float)[chosen])),
    }
    return np.array([quantities[name] for name in QUANTITY_NAMES])


def sample_problem(record: SampleRecord) -> str | None:
    """Why the fit cannot use a sample, in one line; None if it can."""
    if record.failed is not None or record.sample is None:
        return record.failed or "no answer"
    bump = float(np.array(record.sample["natural_bump_mm"], dtype=float).min())
    if record.sample["length_mm"] > 0 and not bump > 0:
        return f"the star is not up: bump {bump:.3g} mm"
    values = sample_quantities(record.sample, record.task.stretch)
    for name, value in zip(QUANTITY_NAMES, values, strict=True):
        if not np.isfinite(value) or (QUANTITIES[name].form == "log" and value <= 0):
            return f"{name} = {value:.3g} is no answer"
    return None


def sample_row(record: SampleRecord, columns: int) -> Floats | None:
    """(Q + K + 2 W,) quantities, differences between directions (K = `columns`) and corrugation; None if unusable."""
    if sample_problem(record) is not None or record.sample is None:
        return None
    bare = record.task.is_bare
    anisotropy = sample_anisotropy(record.sample) if columns and not bare else np.zeros(columns)
    corrugation = np.array(record.sample["relief"], dtype=float).ravel()
    quantities = sample_quantities(record.sample, record.task.stretch)
    return np.concatenate([quantities, anisotropy, np.where(bare, 0.0, corrugation)])


def record_data(record: SampleRecord) -> dict[str, Any]:
    """A record as plain data for the law's file, without the times, which differ from run to run."""
    sample = record.sample and {k: v for k, v in record.sample.items() if k != "seconds"}
    return {
        "stretch": record.task.stretch,
        "held_out": record.task.held_out,
        **named_sizes(record.task.sizes),
        "problem": sample_problem(record),
        "sample": sample,
    }
