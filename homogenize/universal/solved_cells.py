"""Solved cells of the universal law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.homogenize.law.law_table import QUANTITY_NAMES
from asterism.homogenize.universal.groups import GROUPS
from asterism.pattern.design.lattice import Lattice

# powers of the spacing and of `E2 h2` that each quantity is divided by
LENGTH_POWERS = {"kappa": -1, "bending": 2, "c3": 3, "offset_mm": 1}
FORCE_POWERS = {"bending": 1, "a11": 1, "a12": 1, "c3": 1}
WAVE_COUNT = len(CorrugationWaves.of(Lattice()))
# distance of the flat cell's stiffness from isotropy, see `cell.isotropy`
ANISOTROPY = "anisotropy"
# smallest eigenvalues on 2 x 2 stars over `E2 h2`, of the flat cell and of its natural tubes
EIGENVALUES = ("flat_eigenvalue", "rolled_eigenvalue")
WAVE_NAMES = (*(f"flat_{n}" for n in range(WAVE_COUNT)), *(f"rolled_{n}" for n in range(WAVE_COUNT)))
ROW_NAMES = (*QUANTITY_NAMES, *WAVE_NAMES, *EIGENVALUES, ANISOTROPY)


def quantity_scales(spacing_mm: float, force: float) -> Floats:
    """(Q,) units of `law_table.QUANTITY_NAMES`: a quantity is its dimensionless value times its unit.

    Parameters
    ----------
    force : N/mm, modulus times thickness of the fabric.
    """
    return np.array(
        [spacing_mm ** LENGTH_POWERS.get(name, 0) * force ** FORCE_POWERS.get(name, 0) for name in QUANTITY_NAMES]
    )


@dataclass(frozen=True)
class SolvedCells:
    """The answers of n cells.

    Attributes
    ----------
    groups : (n, G) in the order of `groups.GROUPS`.
    rows : (n, R) dimensionless values of `cell_rows.ROW_NAMES`; NaN without an answer.
    problems : n reasons why a cell cannot make the law; empty for one that can.
    seconds : (n,) wall time.
    """

    groups: Floats
    rows: Floats
    problems: tuple[str, ...]
    seconds: Floats

    def __post_init__(self) -> None:
        n = len(self.groups)
        shapes = (self.groups.shape, self.rows.shape, len(self.problems), len(self.seconds))
        if shapes != ((n, len(GROUPS)), (n, len(ROW_NAMES)), n, n):
            raise ValueError(f"groups, rows, problems and seconds do not fit together: {shapes}")

    @classmethod
    def none(cls) -> Self:
        """No cells."""
        return cls(np.empty((0, len(GROUPS))), np.empty((0, len(ROW_NAMES))), (), np.empty(0))

    @property
    def usable(self) -> Bools:
        """(n,) the cells that can make the law."""
        return np.array([not problem for problem in self.problems], dtype=bool)

    def __getitem__(self, chosen: slice) -> SolvedCells:
        """Some of the cells."""
        return SolvedCells(self.groups[chosen], self.rows[chosen], self.problems[chosen], self.seconds[chosen])

    def __len__(self) -> int:
        return len(self.groups)

    def __add__(self, more: SolvedCells) -> SolvedCells:
        """These cells, then more of them."""
        return SolvedCells(
            np.vstack([self.groups, more.groups]),
            np.vstack([self.rows, more.rows]),
            self.problems + more.problems,
            np.concatenate([self.seconds, more.seconds]),
        )
