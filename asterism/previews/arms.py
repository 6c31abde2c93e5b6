"""Moves of the arms along the smooth surface: an arm keeps its length l where the sheet contracts to `lam l`, so that
its tip lies `(1 - lam) l` further out on the sheet. Arms that meet tip to tip are compressed a little.

The fabric beside an arm follows it (`asterism.previews.arm_shares`). Supported points stay in place.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.pattern.layout.layout import Layout
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.places import smooth_surface

# arms whose unit vectors differ by less are the same: rounding leaves 1e-13, and two arms of a star differ by 1 or more
SAME_DIRECTION = 1e-6
# shorter lengths are replaced by this one in divisions
MIN_LENGTH_MM = 1e-9


class Arms:
    """The arms of a layout, for all shells on one mesh of the sheet.

    Attributes
    ----------
    layout, model : as given.
    centre, tip : (A, 2) mm, both ends of the arms.
    length : (A,) mm.
    room : (A,) mm, distance of the tips from the supports.
    direction : (A, 2) unit vectors of the arms, from the centre to the tip.
    """

    def __init__(self, layout: Layout, space: Argyris, model: PreviewModel = PREVIEW_MODEL) -> None:
        self.model = model
        self._follow(layout, space)

    def _follow(self, layout: Layout, space: Argyris) -> None:
        """Compute what depends on the lengths of the arms."""
        self.layout, self.tip = layout, layout.arm_tip
        self.centre = layout.centres[layout.arm_star]
        self.length = np.maximum(layout.arm_length, MIN_LENGTH_MM)
        self.direction = (self.tip - self.centre) / self.length[:, None]
        self._at_tips = space.locate(self.tip)
        self.room = np.maximum(layout.distance_to_supports(self.tip), MIN_LENGTH_MM)

    def with_layout(self, layout: Layout) -> Arms:
        """A copy for another layout whose arms have the same printed positions."""
        arms = copy(self)
        arms.layout = layout
        return arms

    def with_lengths(self, layout: Layout, space: Argyris) -> Arms | None:
        """The arms of another layout with other lengths only; None if more has changed."""
        if not (
            np.array_equal(layout.arm_star, self.layout.arm_star)
            and np.array_equal(layout.centres, self.layout.centres)
        ):
            return None
        arms = copy(self)
        arms._follow(layout, space)
        return arms if np.abs(arms.direction - self.direction).max(initial=0.0) < SAME_DIRECTION else None

    def moves(self, x: Floats) -> Floats:
        """(A, 2) mm in print, how far the tips move along the sheet, for degrees of freedom x (N, 3) of the shell."""
        tip, length, model = smooth_surface(self._at_tips, x), self.length, self.model
        if "arms that keep their length" not in model.parts:
            return np.zeros_like(self.tip)
        stretch = np.linalg.norm(np.einsum("ai,aic->ac", self.direction, tip.tangents), axis=1)
        excess = np.clip((1.0 - stretch) * length, 0.0, model.arm_support_share * self.room)
        return np.asarray((excess / np.maximum(stretch, MIN_LENGTH_MM))[:, None] * self.direction)
