"""Positions of the arms relative to the smooth surface: arms keep their length, and bend differently.

The corrugation of the cells (`asterism.previews.corrugation.bumps`) moves the sheet along its normal, in the same way
for all arms of a star. As rods, the arms also differ from the sheet:

- **Length.** An arm keeps its length l where the sheet contracts to `lam l`, so that its tip lies `(1 - lam) l` further
  out on the sheet. Arms that meet tip to tip are compressed a little.
- **Bending.** The arms of a star meet at a rigid joint. Therefore an arm bends with the mean curvature H of the sheet
  too, not only with the curvature along the arm. If the sheet at the tip is f below its tangent plane at the centre of
  the star, the tip is `(1 - m) f + m H l^2 / 2` below this plane, with m = `arm_mean_share`. On a tube, even the arms
  along the axis curl.
- **Last arms.** A last arm has no star ahead, and the fabric beyond its tip cannot bend it back. Its tip is f below the
  tangent plane, but at least `k kappa l^2 / 4`, with k = `last_arm_share`: a share of its value on the natural tube.
  Such tips are often the lowest points of a sheet.

The fabric beside an arm follows it. Supported points stay in place.
"""

from __future__ import annotations

from copy import copy

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.previews.fields.star_arms import are_last_arms
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from asterism.previews.surface.smooth_surface import smooth_surface
from equilibrium.compiled import loop
from fem.elements.argyris import Argyris
from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout

# fabric at the distance q from an arm follows it by exp(-q/b); the crease of this function on the arm is rounded over
# this multiple of b
CREASE_ROUNDING = 0.1
# fabric beyond a tip follows the arm up to this multiple of b
DECAY_LENGTHS = 4.0
# shorter lengths are replaced by this one in divisions
MIN_LENGTH_MM = 1e-9


class Arms:
    """The arms of a layout, for all shells on one mesh of the sheet.

    Attributes
    ----------
    layout : the layout.
    direction : (A, 2) unit vectors of the arms, from the centre to the tip.
    last : (A,) bool, arms without a star ahead.
    at_centres : shape functions of the shell at the centres of the stars.
    """

    def __init__(self, layout: Layout, space: Argyris, model: PreviewModel = PREVIEW_MODEL) -> None:
        self._model = model
        self.layout = layout
        self._centre = layout.centres[layout.arm_star]
        self._length = np.maximum(layout.arm_length, MIN_LENGTH_MM)
        self.direction = (layout.arm_tip - self._centre) / self._length[:, None]
        self._spacing = layout.spacing_mm
        self.last = are_last_arms(layout, self._centre, self.direction, model)
        self.at_centres, self._at_tips = space.locate(layout.centres), space.locate(layout.arm_tip)
        self._room = np.maximum(layout.distance_to_supports(layout.arm_tip), MIN_LENGTH_MM)
        self._pins = layout.pin_points

    def with_layout(self, layout: Layout) -> Arms:
        """A copy for another layout whose arms have the same printed positions."""
        other = copy(self)
        other.layout = layout
        return other

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
        star, length, model = self.layout.arm_star, self._length, self._model
        centre, tip = smooth_surface(self.at_centres, x), smooth_surface(self._at_tips, x)
        stretch = np.linalg.norm(np.einsum("ai,aic->ac", self.direction, tip.tangents), axis=1)
        room = model.arm_support_share * self._room
        excess = np.clip((1.0 - stretch) * length, 0.0, room) if model.has_arm_lengths else np.zeros_like(length)
        out = (excess / np.maximum(stretch, MIN_LENGTH_MM))[:, None] * self.direction
        place = tip.places + tip.moved(out)
        drop = np.einsum("ac,ac->a", centre.places[star] - place, centre.normals[star])
        lift = model.arm_mean_share * (drop - 0.5 * centre.mean_curvature[star] * length**2)
        side, kept = np.sign(kappa[star]), 0.25 * model.last_arm_share * np.abs(kappa[star]) * length**2
        if model.has_last_arms:
            lift = np.where(self.last, side * np.minimum(side * drop - kept, 0.0), lift)
        max_lift = np.minimum(model.max_arm_lift * length, room)
        return out, np.clip(lift, -max_lift, max_lift)

    def beside(self, points: Floats) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Two matrices (n, A): shares of the tips' moves along the sheet and along its normal, at points (n, 2) mm."""
        beside, beyond = (b * self._spacing for b in (self._model.fabric_beside_arm, self._model.fabric_beyond_tip))
        reach = 0.5 * self._length.max() + DECAY_LENGTHS * self._model.fabric_beyond_tip * self._spacing
        to_pin = np.full(len(points), np.inf)
        if len(self._pins):
            to_pin = cKDTree(self._pins).query(points)[0] / beside
        middle = self._centre + 0.5 * self._length[:, None] * self.direction
        order = np.argsort(middle[:, 0], kind="stable")  # the arms near a point are in a strip of x
        strips = np.searchsorted(middle[order, 0], points[:, :1] + [-reach, reach])
        arms = order, strips, middle, self._centre, self.direction, self._length, self._room
        widths = beside, beyond, reach
        given = np.ascontiguousarray(points), np.minimum(to_pin, 1.0), *arms, *widths
        ends, arm, share = np.zeros(len(points) + 1, dtype=np.int32), np.empty(0, dtype=np.int32), np.empty((2, 0))
        _follow(*given, ends, arm, share)
        arm, share = np.empty(ends[-1], dtype=np.int32), np.empty((2, ends[-1]))
        _follow(*given, ends, arm, share)
        first, second = (sp.csr_matrix((values, arm, ends), (len(points), len(self._length))) for values in share)
        return first, second


@loop
def _follow(  # type: ignore[no-untyped-def]
    points, to_pin, order, strips, middle, centre, direction, length, room, beside, beyond, reach, ends, arm, share
):
    """Set the CSR arrays of `Arms.beside`: row pointer `ends` (n + 1,), columns `arm` (m,) and values `share` (2, m).

    A row holds the arms whose middle is within reach of the point. If `arm` is empty, only `ends` is set.
    """
    k = 0
    for p in range(points.shape[0]):
        for a in order[strips[p, 0] : strips[p, 1]]:
            x, y = points[p, 0] - middle[a, 0], points[p, 1] - middle[a, 1]
            if x * x + y * y > reach * reach:
                continue
            if arm.size:
                x, y = points[p, 0] - centre[a, 0], points[p, 1] - centre[a, 1]
                along = x * direction[a, 0] + y * direction[a, 1]
                aside = y * direction[a, 0] - x * direction[a, 1]
                part, ahead = min(max(along / length[a], 0.0), 1.0), max(along - length[a], 0.0)
                near = np.exp(
                    CREASE_ROUNDING - np.sqrt(CREASE_ROUNDING**2 + (aside / beside) ** 2 + (ahead / beyond) ** 2)
                )
                near *= max(1.0 - np.sqrt(aside * aside + ahead * ahead) / room[a], 0.0) * to_pin[p]
                arm[k], share[0, k], share[1, k] = a, part * near, part * part * near
            k += 1
        ends[p + 1] = k
