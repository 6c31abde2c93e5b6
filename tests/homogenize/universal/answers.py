"""Cells of the universal law that answer at once: smooth functions of their groups in place of an equilibrium."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.universal.groups import GROUP_KEYS
from asterism.homogenize.universal.solved_cells import EIGENVALUES, WAVE_NAMES
from asterism.homogenize.universal.universal_law import bare_quantities


def solve(groups: list[float]) -> tuple[dict[str, Any] | None, str | None]:
    """Stars that stiffen their sheet, and curl it the more the larger their couple."""
    group = dict(zip(GROUP_KEYS, groups, strict=True))
    bare = dict(zip(QUANTITY_NAMES, bare_quantities(np.array([groups]))[0], strict=True))
    arm, couple, stiff = group["arm"], group["couple"], np.log(group["bending"])
    quantities = {
        "lam": bare["lam"] * np.exp(0.3 * arm**2),
        "lam_n": bare["lam_n"] * np.exp(0.28 * arm**2),
        "kappa": 300.0 * couple * arm**1.5 * np.exp(-0.3 * (stiff + 5.0)) * (1.0 + group["edge"]),
        "bending": bare["bending"] * np.exp(2.0 * arm),
        "a11": bare["a11"] * np.exp(-0.5 * arm),
        "a12": bare["a12"] * (1.0 - arm),
        "c3": 0.1 * arm * bare["bending"],
        "offset_mm": couple * arm,
    }
    waves = 0.01 * arm * np.arange(len(WAVE_NAMES))
    row = [*(float(quantities[name]) for name in QUANTITY_NAMES), *waves.tolist(), *[1e-3] * len(EIGENVALUES), 0.0]
    problem = "the fabric buckles between the stars" if group["fabric"] < 0.032 and arm > 0.7 else None
    return {"row": row, "problem": problem}, None


def other_code(groups: list[float]) -> tuple[dict[str, Any] | None, str | None]:
    """The answers of other code."""
    sample, failed = solve(groups)
    assert sample is not None
    return {**sample, "row": [1.1 * value for value in sample["row"]]}, failed


def fails(groups: list[float]) -> tuple[dict[str, Any] | None, str | None]:
    return None, "tube: no equilibrium"
