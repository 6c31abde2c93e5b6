"""Positions of printed points in space and on the smooth surface, and the lens that computes them.

After an edit that keeps the print, a lens computes again only what depends on the changed stars.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Evaluation


@dataclass(frozen=True)
class Places:
    """Positions of n printed points in space, and the smooth surface of the shell there."""

    smooth: Floats  # (n, 3) mm, positions on the smooth surface
    tangents: Floats  # (n, 2, 3) derivatives of the position by the printed coordinates
    seconds: Floats  # (n, 3, 3) 1/mm, second derivatives 11, 22, 12
    normals: Floats  # (n, 3) unit normals on the plastic side
    area: Floats  # (n,) area of the surface per printed area
    mean_curvature: Floats  # (n,) 1/mm, positive where the plastic side is convex
    gaussian_curvature: Floats  # (n,) 1/mm^2
    bumps: Floats  # (n, 3) mm, vectors from there to the sheet with its bumps; zero for the sheet of a motif

    @classmethod
    def at(cls, points: Evaluation, x: Floats) -> Self:
        """The smooth surface at the points of an evaluation, for degrees of freedom x (N, 3) of the shell."""
        jets = points.jets(x)
        first, second = jets[:, 1:3], jets[:, 3:]
        cross = np.cross(first[:, 0], first[:, 1])
        area = np.linalg.norm(cross, axis=1)
        normals = cross / area[:, None]
        a11, a22, a12 = (np.einsum("nc,nc->n", first[:, i], first[:, j]) for i, j in ((0, 0), (1, 1), (0, 1)))
        b11, b22, b12 = np.einsum("nkc,nc->kn", second, normals)
        mean = -0.5 * (a22 * b11 + a11 * b22 - 2.0 * a12 * b12) / area**2
        gaussian = (b11 * b22 - b12**2) / area**2
        return cls(jets[:, 0], first, second, normals, area, mean, gaussian, np.zeros(normals.shape))

    @property
    def bumpy(self) -> Floats:
        """(n, 3) mm, positions with bumps."""
        return self.smooth + self.bumps

    def moved(self, shift: Floats) -> Floats:
        """(n, 3) mm, displacement on the surface for a shift (n, 2) mm in print, to second order."""
        one, two = shift.T
        square = np.column_stack([0.5 * one**2, 0.5 * two**2, one * two])
        first = np.einsum("ni,nic->nc", shift, self.tangents)
        return np.asarray(first + np.einsum("nk,nkc->nc", square, self.seconds))


class SheetLens:
    """Computes the positions of a fixed set of printed points (n, 2) mm for shells of one sheet, here without bumps.

    `sheet`, `points`: as given.

    Raises ValueError: these are no points, or one is outside of the sheet.
    """

    def __init__(self, sheet: Any, points: Floats) -> None:
        self.points = np.atleast_2d(np.asarray(points, dtype=float))
        if self.points.shape[1:] != (2,) or not np.isfinite(self.points).all():
            wrong = f"got shape {self.points.shape}"
            raise ValueError(f"points must be finite pairs of mm on the print, shape (n, 2), {wrong}")
        self._at: Evaluation = sheet.space.locate(self.points)
        self.sheet = sheet
        self._follow(None)

    def renewed(self, sheet: Any) -> SheetLens:
        """The lens of the same points on another sheet; after an edit that keeps the print, unchanged parts are shared.

        Raises ValueError: a point is outside of that sheet.
        """
        if sheet is self.sheet:
            return self
        if sheet.space is not self.sheet.space:
            return sheet.lens(self.points)  # type: ignore[no-any-return]
        lens = copy(self)
        lens.sheet = sheet
        lens._follow(self.sheet)
        return lens

    def _follow(self, before: Any) -> None:
        """Compute what the sheet has unlike an earlier one of the same print, or all without one."""

    def __call__(self, x: Floats) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        return Places.at(self._at, x)
