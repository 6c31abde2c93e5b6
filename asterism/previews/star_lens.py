"""Positions of printed points on a sheet of stars: the shell's smooth surface, and the stars' bumps on it."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.corrugation_waves import CorrugationWaves
from asterism.previews.arm_shares import arm_shares
from asterism.previews.bumps import corrugation_heights, flattening, support_factor
from asterism.previews.fields.star_values import StarValues
from asterism.previews.places import Places, SheetLens
from asterism.previews.sheet import Sheet


class StarLens(SheetLens):
    """Computes the positions of a fixed set of printed points (n, 2) mm with bumps, for shells of one sheet."""

    def __init__(self, sheet: Sheet, waves: CorrugationWaves, points: Floats) -> None:
        super().__init__(sheet, points)
        self._model = sheet.model
        self._waves = waves(self.points - sheet.layout.lattice_origin)
        self._spacing, self._held = sheet.layout.spacing_mm, bool(sheet.layout.pins)
        self._stays = support_factor(sheet.layout.distance_to_supports(self.points), self._spacing, sheet.model)
        self._follow_stars(sheet)

    def _follow_stars(self, sheet: Sheet) -> None:
        """Compute everything that depends on the stars or on the positions of the pins in space."""
        self._shares = sheet.stars.cells.shares(self.points)
        self._nearest = cKDTree(sheet.layout.centres).query(self.points)[1]
        self._arms, self._arm_shares = sheet.arms, arm_shares(sheet.arms, self.points)

    def _follow(self, sheet: Sheet) -> None:
        before = self.sheet
        super()._follow(sheet)
        if sheet.stars is not before.stars or not before.has_pins_of(sheet.layout):
            self._follow_stars(sheet)
            return
        self._arms = sheet.arms
        if not before.has_rods_of(sheet.layout):
            self._arm_shares = arm_shares(sheet.arms, self.points, self._arm_shares)

    def __call__(self, x: Floats, values: StarValues) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        smooth = self._smooth(x)
        if "bumps" not in self._model.parts:
            return Places(smooth, np.zeros_like(smooth.places))
        weights = self._shares(values.sizes[:, 0])
        curvature = 2.0 * smooth.mean_curvature
        rim = self._nearest, self._spacing, self._model
        heights = self._stays * corrugation_heights(self._waves, values, weights, curvature, *rim)
        out = self._arms.moves(x)
        if self._held:
            heights *= flattening(values, weights, smooth.area, self._model)
        return Places(smooth, smooth.moved(self._arm_shares.along @ out) + heights[:, None] * smooth.normals)
