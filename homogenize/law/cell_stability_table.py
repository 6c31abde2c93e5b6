"""Stability of a law's cells against neighbours that bump up and down in turn, between the flat cell and the tubes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.axes import AXES, coordinates


@dataclass(frozen=True)
class CellStabilityTable:
    """Smallest eigenvalues on 2 x 2 stars of the cells at one stretch. A law from other sources may have no such cells.

    Attributes
    ----------
    sizes : (n, A) of the stars, in the order of `homogenize.law.axes.AXES`.
    flat, rolled : (n,) N/mm, of the flat cell and of its natural tubes (smallest over the directions).

    Examples
    --------
    >>> table = CellStabilityTable(np.array([[10.0, 0.3, 1.2]]), np.array([-15.0]), np.array([7.0]))
    >>> table.eigenvalues(np.array([[10.0, 0.3, 1.2]] * 3), np.array([0.0, 0.5, 1.0])).tolist()
    [-15.0, -4.0, 7.0]
    """

    sizes: Floats
    flat: Floats
    rolled: Floats

    @classmethod
    def of(cls, samples: Sequence[dict[str, Any]], stretch: float) -> Self:
        """The cells with arms and an answer among samples as in a law's file."""
        known = [
            each for each in samples if each["problem"] is None and each["length_mm"] > 0 and each["stretch"] == stretch
        ]
        return cls(
            np.array([[each[axis.key] for axis in AXES] for each in known]).reshape(-1, len(AXES)),
            np.array([each["sample"]["supercell_eigenvalue"] for each in known]),
            np.array([min(each["sample"]["natural_supercell_eigenvalue"]) for each in known]),
        )

    def eigenvalues(self, sizes: Floats, part: Floats) -> Floats:
        """(S,) N/mm, of the nearest cell of each star, linear between its flat and its natural state; infinite if the
        table has no cells.

        Parameters
        ----------
        sizes : (S, A) of the stars.
        part : (S,) curvature of the sheet over the natural curvature, limited to 0 to 1.
        """
        if not len(self.sizes):
            return np.full(len(sizes), np.inf)
        known, asked = coordinates(self.sizes), coordinates(sizes)
        span = np.maximum(np.ptp(known, axis=0), 1e-9)
        nearest = np.linalg.norm((asked[:, None] - known) / span, axis=2).argmin(axis=1)
        flat, rolled = self.flat[nearest], self.rolled[nearest]
        return np.asarray(flat + np.clip(part, 0.0, 1.0) * (rolled - flat))
