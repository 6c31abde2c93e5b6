"""Solved cells of the universal law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from asterism.equilibrium.arrays import Bools, Floats
from asterism.homogenize.universal.groups import GROUPS
from asterism.homogenize.universal.row_names import ROW_NAMES


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
