"""What may set a preview apart from the exact shape, known before either is computed."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import layout
from asterism.previews.fields.star_values import star_values

# the largest on each sheet
CAUSES = {
    "across": "stars across",
    "rim": "share outside the stars' cells",
    "gradient": "contraction, star to star, %",
    "bend_step": "turn, star to star, rad",
    "turn": "natural turn over one spacing, rad",
    "softness": "smallest eigenvalue, exact, N/mm",
}


def causes(design: Design, law: Law) -> dict[str, Any]:
    """Numbers for `CAUSES`, but the last one; empty where the law is for another material."""
    plan = layout(design)
    try:
        value = star_values(design, plan, law).value
    except LawError:
        return {}
    spacing = plan.spacing_mm
    cell = abs(float(np.linalg.det(plan.lattice_vectors)))
    lam, turn = value["lam_n"][:-1], value["kappa"][:-1] * value["lam_n"][:-1] * spacing
    i, j = plan.neighbours.T
    return {
        "held": "free" if not plan.pins else "held",
        "across": plan.diameter_mm / spacing,
        "rim": 1.0 - len(plan.centres) * cell / polygon_area(plan.outline),
        "gradient": 100.0 * float(np.abs(np.log(lam[i] / lam[j])).max(initial=0.0)),
        "bend_step": float(np.abs(turn[i] - turn[j]).max(initial=0.0)),
        "turn": float(np.abs(turn).max()),
    }
