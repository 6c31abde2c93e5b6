"""The unknowns of a fit: length and thickness of each star, with their bounds, scales and smoothness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.fitting.first_guess import FITTED_SIZE_DECIMALS
from asterism.fitting.star_menu import StarMenu
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import with_painted_stars

# an unknown of 1 is this change: of a length in mm, and of the logarithm of a thickness
LENGTH_UNIT_MM, THICKNESS_UNIT = 1.0, 0.15


@dataclass(frozen=True, eq=False)
class StarUnknowns:
    """Length and thickness of S stars, and the bounds of both.

    Attributes
    ----------
    plan : of the print.
    menu : sizes that the law covers.
    lengths_mm, thicknesses_mm : (S,).
    """

    plan: Layout
    menu: StarMenu
    lengths_mm: Floats
    thicknesses_mm: Floats

    @classmethod
    def of(cls, plan: Layout, menu: StarMenu) -> StarUnknowns:
        """The unknowns of a layout."""
        sizes = plan.star_sizes_mm
        return cls(plan, menu, sizes[:, 0].copy(), sizes[:, 1].copy())

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """(2 S,) smallest and largest change of the unknowns."""
        menu, lengths, thicknesses = self.menu, self.lengths_mm, self.thicknesses_mm
        low, high = (
            np.concatenate([(length - lengths) / LENGTH_UNIT_MM, np.log(thickness / thicknesses) / THICKNESS_UNIT])
            for length, thickness in zip(
                menu.lengths_mm[[0, -1]], (menu.least_thickness(lengths), menu.thicknesses_mm[-1]), strict=True
            )
        )
        return np.minimum(low, 0.0), np.maximum(high, 0.0)

    @property
    def share_at_bounds(self) -> float:
        """Share of the stars whose length is the smallest or the largest one."""
        low, high = self.menu.lengths_mm[[0, -1]]
        return float(((self.lengths_mm <= low + 1e-6) | (self.lengths_mm >= high - 1e-6)).mean())

    @property
    def units(self) -> Floats:
        """(2 S,) mm, change of each size for a change of its unknown by 1."""
        return np.concatenate([np.full(len(self.lengths_mm), LENGTH_UNIT_MM), THICKNESS_UNIT * self.thicknesses_mm])

    def moved(self, step: Floats) -> StarUnknowns:
        """The unknowns after a step (2 S,) within the bounds."""
        lengths, thicknesses = np.split(step, 2)
        return StarUnknowns(
            self.plan,
            self.menu,
            np.clip(self.lengths_mm + LENGTH_UNIT_MM * lengths, self.menu.lengths_mm[0], self.menu.lengths_mm[-1]),
            np.minimum(self.thicknesses_mm * np.exp(THICKNESS_UNIT * thicknesses), self.menu.thicknesses_mm[-1]),
        )

    def difference(self, start: StarUnknowns) -> Floats:
        """(2 S,) unknowns relative to those of a start."""
        lengths = (self.lengths_mm - start.lengths_mm) / LENGTH_UNIT_MM
        return np.concatenate([lengths, np.log(self.thicknesses_mm / start.thicknesses_mm) / THICKNESS_UNIT])

    def length_change(self, start: StarUnknowns) -> float:
        """mm, largest change of a length from a start."""
        return float(np.abs(self.lengths_mm - start.lengths_mm).max())

    def design(self, base: Design) -> Design:
        """A design with these sizes."""
        sizes = np.column_stack([self.lengths_mm, self.thicknesses_mm]).round(FITTED_SIZE_DECIMALS)
        return with_painted_stars(base, self.plan.sites, np.column_stack([sizes, np.full(len(sizes), np.nan)]))

    def roughness(self) -> sp.csr_array:
        """(2 S, 2 S) matrix R with `z R z` the mean square difference of the unknowns z of neighbouring stars."""
        pairs, count = self.plan.sample_pairs, len(self.lengths_mm)
        rows, signs = np.repeat(np.arange(len(pairs)), 2), np.tile([1.0, -1.0], len(pairs))
        ends = sp.coo_array((signs, (rows, pairs.ravel())), shape=(len(pairs), count)).tocsr()
        of_one_size = ends.T @ ends / max(len(pairs), 1)
        return sp.csr_array(sp.block_diag([of_one_size, of_one_size]))

    def smooth_basis(self) -> Floats:
        """(2 S, m) orthonormal smooth changes: polynomials of the printed coordinates, of degree 2 and 1."""
        centres = self.plan.centres - self.plan.centres.mean(axis=0)
        x, y = (centres / np.abs(centres).max()).T
        powers = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y])
        return np.asarray(sp.block_diag([np.linalg.qr(powers[:, :count])[0] for count in (6, 3)]).toarray())
