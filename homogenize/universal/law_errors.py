"""Errors of the universal law at cells that are left out, one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilibrium.arrays import Bools, Floats
from homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from homogenize.universal.universal_law import UniversalLaw

# An error is relative to the value of the cell, or to this value if that is larger. Values are dimensionless. The floor
# of the curvature is a fiftieth over the spacing: a sheet of 10 stars across then rises by a fortieth of its diameter.
DIMENSIONLESS_ERROR_FLOORS = {"kappa": 0.02, "a12": 0.05, "c3": 2e-4, "offset_mm": 0.005}
SHARES_PERCENT = (50, 95, 99)
_KAPPA = QUANTITY_NAMES.index("kappa")


@dataclass(frozen=True)
class LeftOutErrors:
    """Errors of the law at its scale-separated cells.

    Attributes
    ----------
    percent : (n, Q) absolute errors of `law_table.QUANTITY_NAMES` at each cell of the law.
    separated : (n,) the cells that are scale-separated; errors of others do not count.
    spread : (n,) the cells that are spread over the whole range; others lie where the law was worst, or on the tables
        of one material.
    """

    percent: Floats
    separated: Bools
    spread: Bools

    def table(self) -> dict[str, Floats]:
        """For each quantity the errors that `SHARES_PERCENT` of the spread cells do not exceed, %."""
        counted = self.percent[self.separated & self.spread]
        return {
            name: np.percentile(counted[:, n], SHARES_PERCENT) if len(counted) else np.full(len(SHARES_PERCENT), np.nan)
            for n, name in enumerate(QUANTITY_NAMES)
        }


def left_out_errors(law: UniversalLaw) -> LeftOutErrors:
    """The errors of the law at each of its cells if it goes through all others."""
    cells, given = law.rows[:, : len(QUANTITY_NAMES)], law.left_out
    floors = np.array([DIMENSIONLESS_ERROR_FLOORS.get(name, 0.0) for name in QUANTITY_NAMES])
    percent = 100.0 * np.abs(given - cells) / np.maximum(np.abs(cells), floors)
    return LeftOutErrors(percent, np.abs(cells[:, _KAPPA]) <= MAX_SEPARATED_CURL, law.spread)
