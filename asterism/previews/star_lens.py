"""Positions of printed points on a sheet of stars: the shell's smooth surface, and the stars' bumps on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.previews.arm_shares import arm_shares
from asterism.previews.bumps import corrugation_heights, flattening
from asterism.previews.places import Places, SheetLens

if TYPE_CHECKING:
    from asterism.previews.sheet import Sheet


class StarLens(SheetLens):
    """Computes the positions of a fixed set of printed points (n, 2) mm with bumps, for shells of one sheet."""

    sheet: Sheet

    def __init__(self, sheet: Sheet, points: Floats) -> None:
        super().__init__(sheet, points)
        self._waves = sheet.law.waves(self.points - sheet.layout.lattice_origin)
        far = sheet.layout.distance_to_supports(self.points)
        self._stays = np.minimum(far / (sheet.model.fabric_beyond_tip * sheet.layout.spacing_mm), 1.0)
        self._follow_stars(sheet)

    def _follow_stars(self, sheet: Sheet) -> None:
        """Compute everything that depends on the stars or on the positions of the pins in space."""
        self._shares = sheet.stars.cells.shares(self.points)
        self._nearest = cKDTree(sheet.layout.centres).query(self.points)[1]
        self._arm_shares = arm_shares(sheet.arms, self.points)

    def _follow(self, sheet: Sheet) -> None:
        before = self.sheet
        super()._follow(sheet)
        if sheet.law is not before.law:
            self._waves = sheet.law.waves(self.points - sheet.layout.lattice_origin)
        if sheet.stars is not before.stars or not before.has_pins_of(sheet.layout):
            self._follow_stars(sheet)
        elif not before.has_rods_of(sheet.layout):
            self._arm_shares = arm_shares(sheet.arms, self.points, self._arm_shares)

    def __call__(self, x: Floats) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        smooth, sheet = self._smooth(x), self.sheet
        values, model = sheet.values, sheet.model
        if "bumps" not in model.parts:
            return Places(smooth, np.zeros_like(smooth.places))
        weights = self._shares(values.sizes[:, 0])
        curvature = 2.0 * smooth.mean_curvature
        rim = self._nearest, sheet.layout.spacing_mm, model
        heights = self._stays * corrugation_heights(self._waves, values, weights, curvature, *rim)
        if sheet.layout.pins:
            heights *= flattening(values, weights, smooth.area, model)
        moves = self._arm_shares.along @ sheet.arms.moves(x)
        return Places(smooth, smooth.moved(moves) + heights[:, None] * smooth.normals)
