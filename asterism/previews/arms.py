"""Moves of the arms along the smooth surface, and of the fabric beside them.

An arm keeps its length l where the sheet contracts to `lam l`, so that its tip lies `(1 - lam) l` further out on the
sheet. Arms that meet tip to tip are compressed a little. Fabric at the distance q from an arm follows the arm by
exp(-q/b). Supported points stay in place.

The shares of an arm in the moves at fixed points depend on that arm alone, so an edit that changes a few arms needs new
shares of these only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris
from asterism.pattern.layout.layout import Layout
from asterism.previews.places import smooth_surface

# spacings, in which the fabric beside an arm and beyond its tip follows it: b. Both follow from flat cells, as in
# pytest tests/asterism/previews/test_arms.py
FABRIC_BESIDE_ARM = 0.15
FABRIC_BEYOND_TIP = 0.25
# share of the distance to a support that a tip moves at most; origin unknown
ARM_SUPPORT_SHARE = 0.25
# the crease of exp(-q/b) on the arm is rounded over this multiple of b
CREASE_ROUNDING = 0.1
# fabric beyond a tip follows the arm up to this multiple of b
DECAY_LENGTHS = 4.0
# shorter lengths are replaced by this one in divisions
MIN_LENGTH_MM = 1e-9


class Arms:
    """The arms of a layout, for all shells on one mesh of the sheet.

    Attributes
    ----------
    layout : as given.
    centre, tip : (A, 2) mm, both ends of the arms.
    length : (A,) mm.
    room : (A,) mm, distance of the tips from the supports.
    direction : (A, 2) unit vectors of the arms, from the centre to the tip.
    """

    def __init__(self, layout: Layout, space: Argyris) -> None:
        self.layout, self.tip = layout, layout.arm_tip
        self.centre = layout.centres[layout.arm_star]
        self.length = np.maximum(layout.arm_length, MIN_LENGTH_MM)
        self.direction = (self.tip - self.centre) / self.length[:, None]
        self.room = np.maximum(layout.distance_to_supports(self.tip), MIN_LENGTH_MM)
        self._at_tips = space.locate(self.tip)

    def moves(self, x: Floats) -> Floats:
        """(A, 2) mm in print, how far the tips move along the sheet, for degrees of freedom x (N, 3) of the shell."""
        tangents = smooth_surface(self._at_tips, x).tangents
        stretch = np.linalg.norm(np.einsum("ai,aic->ac", self.direction, tangents), axis=1)
        excess = np.clip((1.0 - stretch) * self.length, 0.0, ARM_SUPPORT_SHARE * self.room)
        return np.asarray((excess / np.maximum(stretch, MIN_LENGTH_MM))[:, None] * self.direction)


@dataclass(frozen=True, eq=False)
class ArmShares:
    """Shares of A arms at n points; made by `arm_shares`.

    Attributes
    ----------
    arms : the arms.
    points : the points.
    to_pin : (n,) distance to the nearest supported point over that in which fabric follows an arm; at most 1.
    reach : mm, distance from the middle of an arm up to which fabric follows it.
    along : (n, A) shares of the tips' moves along the sheet.
    """

    arms: Arms
    points: cKDTree
    to_pin: Floats
    reach: float
    along: sp.csc_matrix


def arm_shares(arms: Arms, points: Floats, before: ArmShares | None = None) -> ArmShares:
    """The shares of all arms at points (n, 2) mm.

    Parameters
    ----------
    before : shares of other arms at these points, on a sheet with the same supported points. Those of arms that are
        the same are used again.
    """
    beside, beyond = (b * arms.layout.spacing_mm for b in (FABRIC_BESIDE_ARM, FABRIC_BEYOND_TIP))
    reach, pins = 0.5 * float(arms.length.max()) + DECAY_LENGTHS * beyond, arms.layout.pin_points
    known = np.zeros(len(arms.length), dtype=bool)
    if before is None:
        tree, to_pin = cKDTree(points), np.ones(len(points))
        if len(pins):
            to_pin = np.minimum(cKDTree(pins).query(points)[0] / beside, 1.0)
    else:
        tree, to_pin = before.points, before.to_pin
        if len(before.arms.length) == len(arms.length) and before.reach == reach:
            known = (before.arms.centre == arms.centre).all(axis=1) & (before.arms.tip == arms.tip).all(axis=1)
    new = np.flatnonzero(~known)
    middle = arms.centre[new] + 0.5 * arms.length[new, None] * arms.direction[new]
    pairs = cKDTree(middle).sparse_distance_matrix(tree, reach, output_type="ndarray")
    arm, point = new[pairs["i"]], np.ascontiguousarray(pairs["j"])
    offset, direction = points[point] - arms.centre[arm], arms.direction[arm]
    along = np.einsum("pc,pc->p", offset, direction)
    follows = along > 0.0  # the others are behind the centre of the star
    aside = (offset[:, 1] * direction[:, 0] - offset[:, 0] * direction[:, 1])[follows]
    arm, point, along = arm[follows], point[follows], along[follows]
    length = arms.length[arm]
    part, ahead = np.minimum(along / length, 1.0), np.maximum(along - length, 0.0)
    near = np.exp(CREASE_ROUNDING - np.sqrt(CREASE_ROUNDING**2 + (aside / beside) ** 2 + (ahead / beyond) ** 2))
    near *= np.maximum(1.0 - np.sqrt(aside**2 + ahead**2) / arms.room[arm], 0.0) * to_pin[point]
    shares = sp.csc_matrix((part * near, (point, arm)), shape=(len(points), len(known)))
    if before is not None and known.any():
        shares = shares + before.along.multiply(known)
    return ArmShares(arms, tree, to_pin, reach, sp.csc_matrix(shares))
