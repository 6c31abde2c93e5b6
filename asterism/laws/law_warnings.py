"""Warnings about the accuracy of a law: held-out cells, mesh, stability of its cells, omitted directions.

Each is one line, or None without a reason to warn.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.homogenize.cell.point_group import (
    MIN_RESOLVED_CURL,
    curvature_misfit,
    is_threefold,
    omitted_anisotropy,
)
from asterism.homogenize.law.anisotropy import predicted_curvatures
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.star_law import MAX_SEPARATED_CURL, StarLaw
from asterism.previews.model import PREVIEW_MODEL

# rms over the held-out cells, above which a law warns
MAX_HELD_OUT_ERROR_PERCENT = 5.0
# of the cells, above which a law warns; in the paper's law 1.4 % are unstable, none of them scale-separated
MAX_UNSTABLE_SHARE = 0.1
# of natural curvatures in directions that are equal by symmetry, above which a law warns
MAX_ASYMMETRY_PERCENT = 10.0
CHECKED_QUANTITIES = {"kappa": "curvature", "curvature": "curvature", "bending": "bending stiffness"}


def held_out_warning(law: Law[Any]) -> str | None:
    """A large error at the held-out cells, at the worst stretch."""
    largest: list[tuple[float, str]] = []
    for stretch, kinds in law.residuals.items():
        errors = kinds["held_out"]["errors"]
        rms = {words: errors[name]["rms_percent"] for name, words in CHECKED_QUANTITIES.items() if name in errors}
        worst = max(rms.values(), default=0.0)
        if worst > MAX_HELD_OUT_ERROR_PERCENT:
            words = " and ".join(f"{percent:.0f} % in {what}" for what, percent in rms.items())
            largest.append((worst, f"at stretch {stretch} the law's error at its held-out cells is {words} (rms)"))
    return f"{max(largest)[1]}: a plan with more sizes makes it smaller" if largest else None


def symmetry_warning(law: StarLaw) -> str | None:
    """Cells whose stars break the symmetry of star and lattice, so that equal directions curl differently."""
    percent = max(
        (kinds["symmetry"]["largest_percent"] for kinds in law.residuals.values() if "symmetry" in kinds), default=0.0
    )
    if percent <= MAX_ASYMMETRY_PERCENT:
        return None
    return (
        f"stars of the law's cells bend out of their symmetry: natural curvatures of equal directions differ by up to "
        f"{percent:.0f} %, and the law takes the direction of lower energy"
    )


def pleat_warning(law: StarLaw) -> str | None:
    """Many cells whose natural tubes are unstable on 2 x 2 stars: adjacent stars rise and fall in turn."""
    tubes = [kinds["tubes"] for kinds in law.residuals.values() if "tubes" in kinds]
    count, unstable = (sum(each[name] for each in tubes) for name in ("count", "unstable"))
    if unstable <= MAX_UNSTABLE_SHARE * count:
        return None
    return (
        f"the natural tubes of {unstable} of the law's {count} cells are unstable on 2 x 2 stars: "
        "the exact model may take another form, with pleats, which the smooth surface cannot show"
    )


def directions_warning(law: StarLaw) -> str | None:
    """What the law leaves out, and how much previews misjudge natural curvatures by that; None if it is complete.

    The numbers are those of the worst direction of each cell that curls and is scale-separated.
    """
    missing = omitted_anisotropy(law.plan.design.lattice)
    if missing is None:
        return None
    samples = [cell["sample"] for cell in law.samples if cell["problem"] is None and cell["length_mm"] > 0]
    curls = [np.abs(sample["natural_curvature"]).max() * sample["spacing_mm"] for sample in samples]
    bounds = MIN_RESOLVED_CURL, MAX_SEPARATED_CURL
    curled = [sample for sample, curl in zip(samples, curls, strict=True) if bounds[0] < curl < bounds[1]]
    if not curled:
        return missing
    threefold = is_threefold(law.plan.design.lattice)
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
