"""The unknowns of a fit: length and thickness of each star, with their bounds, scales and smoothness."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Floats
from asterism.fitting.first_guess import FITTED_SIZE_DECIMALS
from asterism.fitting.reach import StarMenu
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import with_painted_stars

# an unknown of 1 is a change of a length by 1 mm, or of the logarithm of a thickness by this number
THICKNESS_UNIT = 0.15


@dataclass(frozen=True, eq=False)
class StarUnknowns:
    """Length and thickness of S stars as one vector, and its bounds.

    Attributes
    ----------
    plan : of the print.
    menu : sizes that the law covers.
    values : (2 S,) lengths in mm, then logarithms of thicknesses in mm over `THICKNESS_UNIT`.
    """

    plan: Layout
    menu: StarMenu
    values: Floats

    @classmethod
    def of(cls, plan: Layout, menu: StarMenu) -> StarUnknowns:
        """The unknowns of a layout."""
        lengths, thicknesses = plan.star_sizes_mm[:, :2].T
        return cls(plan, menu, np.concatenate([lengths, np.log(thicknesses) / THICKNESS_UNIT]))

    @cached_property
    def sizes_mm(self) -> Floats:
        """(S, 2) lengths and thicknesses."""
        lengths, logarithms = np.split(self.values, 2)
        return np.column_stack([lengths, np.exp(THICKNESS_UNIT * logarithms)])

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """(2 S,) smallest and largest change of the unknowns."""
        menu, lengths = self.menu, self.sizes_mm[:, 0]
        least = menu.least_thickness(lengths), np.full(len(lengths), menu.thicknesses_mm[-1])
        low, high = (
            np.concatenate([np.full(len(lengths), end), np.log(thickness) / THICKNESS_UNIT]) - self.values
            for end, thickness in zip(menu.lengths_mm[[0, -1]], least, strict=True)
        )
        return np.minimum(low, 0.0), np.maximum(high, 0.0)

    @property
    def share_at_bounds(self) -> float:
        """Share of the stars whose length is the smallest or the largest one."""
        (low, high), lengths = self.menu.lengths_mm[[0, -1]], self.sizes_mm[:, 0]
        return float(((lengths <= low + 1e-6) | (lengths >= high - 1e-6)).mean())

    @property
    def units(self) -> Floats:
        """(2 S,) mm, change of each size for a change of its unknown by 1."""
        return np.concatenate([np.ones(len(self.sizes_mm)), THICKNESS_UNIT * self.sizes_mm[:, 1]])

    def moved(self, step: Floats) -> StarUnknowns:
        """The unknowns after a step (2 S,), with lengths of the menu, and thicknesses up to its largest one."""
        menu, (lengths, logarithms) = self.menu, np.split(self.values + step, 2)
        thickest = np.log(menu.thicknesses_mm[-1]) / THICKNESS_UNIT
        lengths = np.clip(lengths, menu.lengths_mm[0], menu.lengths_mm[-1])
        return replace(self, values=np.concatenate([lengths, np.minimum(logarithms, thickest)]))

    def length_change(self, start: StarUnknowns) -> float:
        """mm, largest change of a length from a start."""
        return float(np.abs(self.sizes_mm[:, 0] - start.sizes_mm[:, 0]).max())

    def design(self, base: Design) -> Design:
        """A design with these sizes."""
        sizes = self.sizes_mm.round(FITTED_SIZE_DECIMALS)
        return with_painted_stars(base, self.plan.sites, np.column_stack([sizes, np.full(len(sizes), np.nan)]))

    def roughness(self) -> sp.csr_array:
        """(2 S, 2 S) matrix R with `z R z` the mean square difference of the unknowns z of neighbouring stars."""
        pairs, count = self.plan.sample_pairs, len(self.sizes_mm)
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
