"""What stars can do at a stretch: contraction and natural curvature over the sizes that the law covers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.star_law import StarLaw

# mm, shortest arms of a fitted design: shorter ones hardly differ from bare fabric
MIN_FITTED_ARM_MM = 2.0
# sizes of the menu
_LENGTHS, _THICKNESSES = 56, 31
# deviations that count as equal when sizes are chosen: of ln(contraction), and of the curvature times the spacing
_CONTRACTION_STEP = 0.01
_TURN_STEP = 0.15


@dataclass(frozen=True, eq=False)
class StarMenu:
    """Stars of one width at one stretch, over a grid of L lengths and H thicknesses.

    Attributes
    ----------
    stretch, spacing_mm, width_mm : of all stars.
    lengths_mm : (L,).
    thicknesses_mm : (H,).
    contraction : (L, H) length over printed length of the natural tube, as in supported previews.
    kappa : (L, H) 1/mm, natural curvature, positive with the plastic outside.
    allowed : (L, H) in the range of the law, and separated in scale from the sheet.
    """

    stretch: float
    spacing_mm: float
    width_mm: float
    lengths_mm: Floats
    thicknesses_mm: Floats
    contraction: Floats
    kappa: Floats
    allowed: np.ndarray

    @classmethod
    def of(cls, law: StarLaw, stretch: float, width_mm: float) -> StarMenu:
        """The menu of a law; `ForeignLaw` if it has no table for the stretch."""
        table = law.at(stretch)
        ranges = table.size_ranges
        low, high = ranges["length_mm"]
        lengths = np.linspace(max(low, MIN_FITTED_ARM_MM), high, _LENGTHS)
        thicknesses = np.geomspace(*ranges["thickness_mm"], _THICKNESSES)
        grid = np.stack(np.meshgrid(lengths, thicknesses, indexing="ij"), axis=-1).reshape(-1, 2)
        stars = table(grid[:, 0], grid[:, 1], width_mm)
        shape = (len(lengths), len(thicknesses))
        contraction, kappa = (stars.value[name].reshape(shape) for name in ("lam_n", "kappa"))
        allowed = (stars.inside & ~stars.not_scale_separated).reshape(shape)
        return cls(stretch, table.spacing_mm, width_mm, lengths, thicknesses, contraction, kappa, allowed)

    @cached_property
    def range(self) -> tuple[float, float]:
        """Smallest and largest contraction of allowed stars."""
        contractions = self.contraction[self.allowed]
        return float(contractions.min()), float(contractions.max())

    @property
    def ratio(self) -> float:
        """Largest contraction over the smallest one: what a target may need at most."""
        low, high = self.range
        return high / low

    def sizes(self, contraction: Floats, kappa: Floats) -> Floats:
        """(S, 2) length and thickness (mm) of the stars nearest to contractions and natural curvatures (S,)."""
        miss = (np.log(self.contraction / contraction[:, None, None]) / _CONTRACTION_STEP) ** 2
        miss += ((self.kappa - kappa[:, None, None]) * self.spacing_mm / _TURN_STEP) ** 2
        best = np.where(self.allowed, miss, np.inf).reshape(len(contraction), -1).argmin(axis=1)
        length, thickness = np.unravel_index(best, self.allowed.shape)
        return np.column_stack([self.lengths_mm[length], self.thicknesses_mm[thickness]])

    def least_thickness(self, lengths_mm: Floats) -> Floats:
        """(S,) mm, smallest thickness of stars of these lengths (S,) from which on all are allowed."""
        # the last thickness that is not allowed, and the next one
        refused = ~self.allowed
        last = np.where(refused.any(axis=1), refused.shape[1] - 1 - refused[:, ::-1].argmax(axis=1), -1)
        least = self.thicknesses_mm[np.minimum(last + 1, len(self.thicknesses_mm) - 1)]
        return np.asarray(np.interp(lengths_mm, self.lengths_mm, least))
