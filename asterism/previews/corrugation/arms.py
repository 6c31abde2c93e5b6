"""How arms lie on the smooth sheet: longer than it, and straighter.

The relief of the cells (`asterism.previews.corrugation.bumps`) moves the sheet along its normal, and is the same for
all arms of a star. But arms are rods:

- **An arm keeps its length** l where the sheet shrinks to `lam l`: its tip lies `(1 - lam) l` further out on the sheet.
  Where tips meet tips both get a little shorter.
- **It bends like the sheet around it**, not only as that bends along the arm, as rods do that meet at a rigid joint.
  If there the sheet is f under the plane that touches it at the star's centre, the tip is under it by
  `(1 - m) f + m H l^2 / 2`, H being the sheet's mean curvature and m `arm_mean_share`. On a tube, arms along the axis
  curl, though the sheet is straight.
- **A last arm**, with no star ahead, has only fabric beyond its tip, which cannot bend it back. Instead, its tip is
  under that plane by f, and by no less than `k kappa l^2 / 4`, k = `last_arm_share` of what it is on the natural
  tube. Such tips often are a sheet's lowest points.

The fabric beside an arm follows it. What is held stays.
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

# fabric at a distance q from an arm follows it by exp(-q/b)
ROUNDING = 0.1  # of that function's crease on the arm, over b
DECAY_LENGTHS = 4.0  # beyond tips, in b, that are counted
MIN_LENGTH_MM = 1e-9  # mm


class Arms:
    """The arms of a layout on shells of one sheet.

    Attributes
    ----------
    at_centres : the shell's functions at the stars' centres.
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
        """The same arms, of a layout whose arms are at the same places."""
        other = copy(self)
        other.layout = layout
        return other

    def moves(self, x: Floats, kappa: Floats) -> tuple[Floats, Floats]:
        """Of the tips: (A, 2) mm of the print, by which they lie further out on the sheet, and (A,) mm, their lift.

        Parameters
        ----------
        x : (N, 3) mm, of the shell's dofs.
        kappa : (S,) or more, 1/mm, natural curvature of the stars.
        """
        star, length, model = self.layout.arm_star, self._length, self._model
        centre, tip = smooth_surface(self.at_centres, x), smooth_surface(self._at_tips, x)
        stretch = np.linalg.norm(np.einsum("ai,aic->ac", self.direction, tip.tangents), axis=1)
        room = model.arm_support_share * self._room
        further = np.clip((1.0 - stretch) * length, 0.0, room) if model.has_arm_lengths else np.zeros_like(length)
        out = (further / np.maximum(stretch, MIN_LENGTH_MM))[:, None] * self.direction
        place = tip.places + tip.moved(out)
        drop = np.einsum("ac,ac->a", centre.places[star] - place, centre.normals[star])
        lift = model.arm_mean_share * (drop - 0.5 * centre.mean_curvature[star] * length**2)
        side, kept = np.sign(kappa[star]), 0.25 * model.last_arm_share * np.abs(kappa[star]) * length**2
        if model.has_last_arms:
            lift = np.where(self.last, side * np.minimum(side * drop - kept, 0.0), lift)
        most = np.minimum(model.max_arm_lift * length, room)
        return out, np.clip(lift, -most, most)

    def beside(self, points: Floats) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """(n, A) each: by how much of its tip's moves, outwards and lifted, each arm takes along points (n, 2)."""
        beside, beyond = (b * self._spacing for b in (self._model.fabric_beside_arm, self._model.fabric_beyond_tip))
        reach = 0.5 * self._length.max() + DECAY_LENGTHS * self._model.fabric_beyond_tip * self._spacing
        to_pin = np.full(len(points), np.inf)
        if len(self._pins):
            to_pin = cKDTree(self._pins).query(points)[0] / beside
        middle = self._centre + 0.5 * self._length[:, None] * self.direction
        order = np.argsort(middle[:, 0], kind="stable")  # a point's arms are among those of a strip
        strips = np.searchsorted(middle[order, 0], points[:, :1] + [-reach, reach])
        arms = order, strips, middle, self._centre, self.direction, self._length, self._room
        widths = beside, beyond, reach
        given = np.ascontiguousarray(points), np.minimum(to_pin, 1.0), *arms, *widths
        ends, arm, share = np.zeros(len(points) + 1, dtype=np.int32), np.empty(0, dtype=np.int32), np.empty((2, 0))
        _follow(*given, ends, arm, share)
        arm, share = np.empty(ends[-1], dtype=np.int32), np.empty((2, ends[-1]))
        _follow(*given, ends, arm, share)
        first, second = (sp.csr_matrix((one, arm, ends), (len(points), len(self._length))) for one in share)
        return first, second


@loop
def _follow(  # type: ignore[no-untyped-def]
    points, to_pin, order, strips, middle, centre, direction, length, room, beside, beyond, reach, ends, arm, share
):
    """Rows of arms whose middle is within reach of each point: ends (n + 1,), arm (m,) and share (2, m).

    The shares are those of `Arms.beside`; without room for any it only counts.
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
                near = np.exp(ROUNDING - np.sqrt(ROUNDING**2 + (aside / beside) ** 2 + (ahead / beyond) ** 2))
                near *= max(1.0 - np.sqrt(aside * aside + ahead * ahead) / room[a], 0.0) * to_pin[p]
                arm[k], share[0, k], share[1, k] = a, part * near, part * part * near
            k += 1
        ends[p + 1] = k
