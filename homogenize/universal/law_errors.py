"""Errors of the universal law at cells that are left out, one by one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.homogenize.law.law_table import MAX_SEPARATED_CURL, QUANTITY_NAMES
from asterism.homogenize.universal.universal_law import UniversalLaw

# An error is relative to the value of the cell, or to this value if that is larger. Values are dimensionless. The floor
# of the curvature is a fiftieth over the spacing: a sheet of 10 stars across then rises by a fortieth of its diameter.
DIMENSIONLESS_ERROR_FLOORS = {"kappa": 0.02, "a12": 0.05, "c3": 2e-4, "offset_mm": 0.005}
SHARES_PERCENT = (50, 95, 99)
# cells whose left-out errors give the error at a star
NEAREST_CELLS = 12
STATED_QUANTITIES = ("lam_n", "kappa", "bending")
# rms of the left-out errors of the nearest cells, %, above which the law does not serve. With these bounds 99 % of the
# served cells are within 0.3 % in lam_n, and 95 % within 8 % in kappa and bending (`asterism law errors`).
MAX_SERVING_ERRORS_PERCENT = {"lam_n": 0.3, "kappa": 12.0, "bending": 12.0}
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
    served : (n,) the cells that the law serves: the errors of the other cells nearest to them are small enough.
    """

    percent: Floats
    separated: Bools
    spread: Bools
    served: Bools

    def counted(self, served_only: bool = False) -> Bools:
        """(n,) the cells that the table counts."""
        return self.separated & self.spread & (self.served | (not served_only))

    def table(self, served_only: bool = False) -> dict[str, Floats]:
        """For each quantity the errors that `SHARES_PERCENT` of the spread cells do not exceed, %."""
        counted = self.percent[self.counted(served_only)]
        return {
            name: np.percentile(counted[:, n], SHARES_PERCENT) if len(counted) else np.full(len(SHARES_PERCENT), np.nan)
            for n, name in enumerate(QUANTITY_NAMES)
        }


def left_out_errors(law: UniversalLaw) -> LeftOutErrors:
    """The errors of the law at each of its cells if it goes through all others."""
    cells, given = law.rows[:, : len(QUANTITY_NAMES)], law.left_out
    floors = np.array([DIMENSIONLESS_ERROR_FLOORS.get(name, 0.0) for name in QUANTITY_NAMES])
    percent = 100.0 * np.abs(given - cells) / np.maximum(np.abs(cells), floors)
    separated = np.abs(cells[:, _KAPPA]) <= MAX_SEPARATED_CURL
    others = law.nearest_cells(law.groups, NEAREST_CELLS + 1)[:, 1:]
    most = np.array([MAX_SERVING_ERRORS_PERCENT[name] for name in STATED_QUANTITIES])
    served = np.all(errors_of_cells(percent, separated, others) <= most, axis=1)
    return LeftOutErrors(percent, separated, law.spread, np.asarray(served))


def errors_of_cells(percent: Floats, separated: Bools, near: Ints) -> Floats:
    """(N, 3) rms of `STATED_QUANTITIES` over the scale-separated of the cells `near` (N, k), %.

    Infinite where fewer than half of these cells are scale-separated: nothing is known there.

    Parameters
    ----------
    percent, separated : of `LeftOutErrors`.
    """
    weight = separated[near][..., None].astype(float)
    squares = weight * percent[near][:, :, [QUANTITY_NAMES.index(name) for name in STATED_QUANTITIES]] ** 2
    count = weight.sum(axis=1)
    rms: Floats = np.sqrt(squares.sum(axis=1) / np.maximum(count, 1.0))
    rms[count[:, 0] < near.shape[1] / 2] = np.inf
    return rms
