"""A warning about the differences between directions that a law leaves out."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.homogenize.cell.tube_directions import (
    MIN_RESOLVED_CURL,
    curvature_misfit,
    is_threefold,
    omitted_anisotropy,
)
from asterism.homogenize.law.anisotropy import predicted_curvatures
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL
from asterism.previews.model import PREVIEW_MODEL


def directions_warning(law: Law) -> str | None:
    """What the law leaves out, and how much previews misjudge natural curvatures by that; None if it is complete.

    The numbers are those of the worst direction of each cell that curls and is scale-separated.
    """
    missing = omitted_anisotropy(law.material.lattice)
    if missing is None:
        return None
    samples = [cell["sample"] for cell in law.samples if cell["problem"] is None and cell["length_mm"] > 0]
    curls = [np.abs(sample["natural_curvature"]).max() * sample["spacing_mm"] for sample in samples]
    bounds = MIN_RESOLVED_CURL, MAX_SEPARATED_CURL
    curled = [sample for sample, curl in zip(samples, curls, strict=True) if bounds[0] < curl < bounds[1]]
    if not curled:
        return missing
    threefold = is_threefold(law.material.lattice)
    misfit = [curvature_misfit(s["natural_curvature"]) if threefold else _preview_misfit(s) for s in curled]
    percent = 100.0 * np.array(misfit)
    return (
        f"{missing}: the natural curvature of the worst direction differs by {np.median(percent):.0f} % in the "
        f"median of {len(percent)} cells, by {percent.max():.0f} % at most"
    )


def _preview_misfit(sample: dict[str, Any]) -> float:
    """Largest difference between a cell's natural curvatures and those in previews, over the largest curvature."""
    kappa = np.array(sample["natural_curvature"])
    return float(
        np.abs(predicted_curvatures(sample, PREVIEW_MODEL.anisotropy_share) - kappa).max() / np.abs(kappa).max()
    )
