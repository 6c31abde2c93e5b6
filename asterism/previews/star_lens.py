"""Positions of the points of a star sheet over the smooth surface of the shell: its bumps, and its arms.

**Bumps.** The law describes the heights of a cell over its mean surface by the amplitudes of a few waves of the lattice
(`homogenize.cell.corrugation_waves`): amplitudes of the flat cell, and their change as the sheet curls to its natural
tube. At a place shared by several stars, the amplitudes are averaged, so that the corrugation has no jumps. The bare
rim is as low as the tips of the arms beside it. A printed point moves by its height along the shell's normal.

**Between the flat and the natural cell.** Stars that hardly buckle in a flat sheet buckle soon after the sheet begins
to curl. In cells of long thin stars, seven tenths of the change are complete when a star turns by half a radian over
its spacing d, independently of its natural curvature kappa. The share of the change at a curvature k is

    s(k) = tanh(k d / t) / tanh(kappa d / t),    t = `BUMP_TURN_RAD`,

which is linear for stars of small natural curvature. In a sheet that is bent to the other side, s(k) is negative.

**Supports that stretch the sheet** flatten the bumps: the tension grows with the strain, and a bump is inversely
proportional to its stiffness. If lengths exceed those of the flat cell by the strain e, the height is divided by
`1 + e / e_0`, with e_0 = `BUMP_STRAIN`.

**At supports** the corrugation is zero, and it grows over the distance in which fabric follows a tip,
`FABRIC_BEYOND_TIP`.

**Arms** keep their length l where the sheet contracts to `lam l`, so that a tip lies `(1 - lam) l` further out on the
sheet. Arms that meet tip to tip are compressed a little. Fabric at the distance q from an arm follows the arm by
exp(-q/b). Supported points stay in place. The shares of an arm in the moves at fixed points depend on that arm alone,
so an edit that changes a few arms needs new shares of these only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.argyris import Argyris
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.star_cells import Shares, beside, stars_share
from asterism.previews.fields.star_values import StarValues
from asterism.previews.model import BUMPS, KEPT_ARMS
from asterism.previews.places import Places, SheetLens


class StarLens(SheetLens):
    """Computes the positions of a fixed set of printed points (n, 2) mm with bumps, for shells of a sheet of stars."""

    def _follow(self, before: Any) -> None:
        sheet, layout = self.sheet, self.sheet.layout
        if before is None:
            far = layout.distance_to_supports(self.points)
            self._stays = np.minimum(far / (FABRIC_BEYOND_TIP * layout.spacing_mm), 1.0)
        if before is None or sheet.law is not before.law:
            self._waves = sheet.law.waves(self.points - layout.lattice_origin)
        if before is None or sheet.stars is not before.stars:
            self._shares = Shares(sheet.stars.shares.cells, self.points)
            self._nearest = cKDTree(layout.centres).query(self.points)[1]
        if before is None or sheet.arms is not before.arms:
            known = None if before is None else self._arm_shares
            self._arm_shares: ArmShares = arm_shares(sheet.arms, self.points, known)

    def __call__(self, x: Floats) -> Places:
        """The positions of the points for degrees of freedom x (N, 3) of the shell."""
        smooth, sheet = super().__call__(x), self.sheet
        values, off = sheet.values, sheet.model.off
        if BUMPS in off:
            return smooth
        weights = self._shares(values.sizes[:, 0])
        rim = 2.0 * smooth.mean_curvature, self._nearest, sheet.layout.spacing_mm
        heights = self._stays * corrugation_heights(self._waves, values, weights, *rim)
        if sheet.layout.pins:
            heights *= flattening(values, weights, smooth.area)
        bumps = heights[:, None] * smooth.normals
        if KEPT_ARMS not in off:
            bumps += smooth.moved(self._arm_shares.along @ sheet.arms.moves(x))
        return replace(smooth, bumps=bumps)


# turn over a spacing in which bumps come most of the way from flat to natural: cells of long thin stars
BUMP_TURN_RAD = 0.55
# strain over the flat cell at which half of a bump is left: a fit to bumps of seven equal stars on held borders
BUMP_STRAIN = 0.045
# smallest natural turn over one spacing in the formula for s(k), to avoid a division by zero
MIN_NATURAL_TURN_RAD = 1e-4


def corrugation_heights(
    waves: Floats,
    values: StarValues,
    weights: sp.csr_matrix,
    curvature: Floats,
    nearest: Ints,
    spacing: float,
) -> Floats:
    """(n,) heights in mm over the smooth surface.

    Parameters
    ----------
    waves : (n, W) the law's waves at the points.
    values : the law at the stars.
    weights : (n, S) share of each star at the points.
    curvature : (n,) 1/mm, sum of the shell's principal curvatures, positive where the plastic side is convex.
    nearest : (n,) nearest star of each point.
    spacing : mm, spacing of the stars.
    """
    flat, more = np.moveaxis(_shared(weights, values.corrugation), 1, 0)
    bent = _bent(_shared(weights, values.value["kappa"]), curvature, spacing)
    stars = np.einsum("nw,nw->n", flat + bent[:, None] * more, waves)
    near = beside(weights, values.value["kappa"][:-1], nearest)
    low, lower = beside(weights, values.tip_heights[:-1], nearest).T
    side = values.side[nearest]
    rim = side * np.minimum(side * (low + _bent(near, curvature, spacing) * lower), 0.0)
    return np.asarray(stars + (1.0 - stars_share(weights)) * rim)


def flattening(values: StarValues, weights: sp.csr_matrix, area: Floats) -> Floats:
    """(n,) factor by which the stretch of a supported sheet reduces the height of its bumps.

    Parameters
    ----------
    weights : (n, S) share of each star.
    area : (n,) area of the sheet per printed area.
    """
    lam = np.maximum(beside(weights, values.value["lam"][:-1]), values.value["lam"].min())
    return np.asarray(1.0 / (1.0 + np.maximum(np.sqrt(area) / lam - 1.0, 0.0) / BUMP_STRAIN))


def _bent(kappa: Floats, curvature: Floats, spacing: float) -> Floats:
    """(n,) `kappa s(k)` in 1/mm at curvatures k (n,): zero for a flat sheet, kappa at the natural curvature."""
    own = np.maximum(np.abs(kappa) * spacing, MIN_NATURAL_TURN_RAD)
    return np.asarray(own / spacing * np.tanh(curvature * spacing / BUMP_TURN_RAD) / np.tanh(own / BUMP_TURN_RAD))


def _shared(weights: sp.csr_matrix, values: Floats) -> Floats:
    """(n, ...) weighted mean of values (S + 1, ...) of the stars and, last, of bare fabric."""
    bare = values[-1]
    more = (values[:-1] - bare).reshape(len(values) - 1, -1)
    return np.asarray(bare + (weights @ more).reshape(-1, *values.shape[1:]))


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
        tangents = Places.at(self._at_tips, x).tangents
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
