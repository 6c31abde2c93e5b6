"""Positions of the arms relative to the smooth surface: arms keep their length, and bend differently.

The corrugation of the cells (`asterism.previews.bumps`) moves the sheet along its normal, in the same way
for all arms of a star. As rods, the arms also differ from the sheet:

- **Length.** An arm keeps its length l where the sheet contracts to `lam l`, so that its tip lies `(1 - lam) l` further
  out on the sheet. Arms that meet tip to tip are compressed a little.
- **Bending.** The arms of a star meet at a rigid joint. Therefore an arm bends with the mean curvature H of the sheet
  too, not only with the curvature along the arm. If the sheet at the tip is f below its tangent plane at the centre of
  the star, the tip is `(1 - m) f + m H l^2 / 2` below this plane, with m = `arm_mean_share`. On a tube, even the arms
  along the axis curl.
- **Last arms.** A last arm has no star ahead, and the fabric beyond its tip cannot bend it back. Its tip is f below the
  tangent plane, but at least `kappa l^2 / 6`: on the natural tube the mean over the directions is `kappa l^2 / 4`, and
  two thirds of it are left if the curvature falls linearly from the joint to nothing at the tip. Such tips are often
  the lowest points of a sheet.

The fabric beside an arm follows it (`asterism.previews.arm_shares`). Supported points stay in place.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.star_arms import are_last_arms
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
    last : (A,) bool, arms without a star ahead.
    at_centres : shape functions of the shell at the centres of the stars.
    """

    def __init__(self, layout: Layout, space: Argyris, model: PreviewModel = PREVIEW_MODEL) -> None:
        self.model = model
        self._follow(layout, space)
        self.last = are_last_arms(layout, self.centre, self.direction, model)
        self.at_centres = space.locate(layout.centres)

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

    def moves(self, x: Floats, kappa: Floats) -> tuple[Floats, Floats]:
        """Compute how far the tips move relative to the smooth surface.

        Parameters
        ----------
        x : (N, 3) degrees of freedom of the shell.
        kappa : (S,) or more, 1/mm, natural curvature of the stars.

        Returns
        -------
        out : (A, 2) mm in print, move along the sheet.
        lift : (A,) mm, move along its normal.
        """
        star, length, model = self.layout.arm_star, self.length, self.model
        centre, tip = smooth_surface(self.at_centres, x), smooth_surface(self._at_tips, x)
        stretch = np.linalg.norm(np.einsum("ai,aic->ac", self.direction, tip.tangents), axis=1)
        room = model.arm_support_share * self.room
        excess = np.clip((1.0 - stretch) * length, 0.0, room) if model.has_arm_lengths else np.zeros_like(length)
        out = (excess / np.maximum(stretch, MIN_LENGTH_MM))[:, None] * self.direction
        place = tip.places + tip.moved(out)
        drop = np.einsum("ac,ac->a", centre.places[star] - place, centre.normals[star])
        lift = model.arm_mean_share * (drop - 0.5 * centre.mean_curvature[star] * length**2)
        side, kept = np.sign(kappa[star]), np.abs(kappa[star]) * length**2 / 6.0
        if model.has_last_arms:
            lift = np.where(self.last, side * np.minimum(side * drop - kept, 0.0), lift)
        return out, np.clip(lift, -room, room)
