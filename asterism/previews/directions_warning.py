"""What a law leaves out where stars are not the same in all directions, in one line for its users."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.previews.model import PREVIEW_MODEL
from homogenize.cell.tube_directions import MIN_RESOLVED_CURL, curvature_misfit, is_threefold, omitted_anisotropy
from homogenize.law.anisotropy import predicted_curvatures
from homogenize.law.law import Law
from homogenize.law.law_table import MAX_SEPARATED_CURL


def directions_warning(law: Law) -> str | None:
    """What is left out, and how far natural curvatures are from a preview's for it; None if nothing is.

    Of the cells that curl, but not tightly: the direction that is furthest off.
    """
    missing = omitted_anisotropy(law.material.lattice)
    if missing is None:
        return None
    found = [cell["sample"] for cell in law.samples if cell["problem"] is None and cell["length_mm"] > 0]
    curled = [
        c
        for c in found
        if MIN_RESOLVED_CURL < np.abs(c["natural_curvature"]).max() * c["spacing_mm"] < MAX_SEPARATED_CURL
    ]
    if not curled:
        return missing
    threefold = is_threefold(law.material.lattice)
    off = 100.0 * np.array(
        [curvature_misfit(c["natural_curvature"]) if threefold else _off_followed(c) for c in curled]
    )
    return (
        f"{missing}: natural curvature of the direction that is furthest off differs by {np.median(off):.0f} % in the "
        f"median of {len(off)} cells, by {off.max():.0f} % at most"
    )


def _off_followed(sample: dict[str, Any]) -> float:
    """How far a cell's natural curvatures are at most from what previews take them for, over the largest."""
    kappa = np.array(sample["natural_curvature"])
    return float(
        np.abs(predicted_curvatures(sample, PREVIEW_MODEL.anisotropy_share) - kappa).max() / np.abs(kappa).max()
    )
