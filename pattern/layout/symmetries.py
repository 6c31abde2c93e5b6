"""Rotations and mirrors of the print that map the whole design onto itself."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.design import Design
from asterism.pattern.design.rods import IMPORT_CURVE_MM
from asterism.pattern.geometry.planar import STRAIGHT_TURN_RAD, turning_angles
from asterism.pattern.layout.drawn_motions import DrawingImages, candidate_turns, maps_holes
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.support_samples import SupportSamples

# of the spacing, or of a size: equal but for rounding
SYMMETRY_TOLERANCE = 1e-6
# two curves that are equal are apart by at most this many of the distances from their straight pieces
CURVE_TOLERANCES = 4.0


@dataclass(frozen=True)
class Symmetry:
    """A motion `p -> turn p + shift` of the print that maps it onto itself.

    Attributes
    ----------
    turn : (2, 2) orthogonal matrix; a mirror if its determinant is -1.
    shift : (2,) mm.
    star : (S,) the star onto which each star is moved; empty for a drawing without stars.
    shift_in_space : (3,) mm, of the supports' places, which may have another centre than the print.

    Notes
    -----
    If `x(p)` is an equilibrium, so is the shape `x'(p) = Q x(turn p + shift)`. Q is any proper rotation if `turn` is
    one. A mirror puts the plastic on the wrong side of the print. So for a mirror Q must be improper: the shape is
    reflected in space too, which leaves its energy unchanged. Of these shapes `in_space` gives the one whose supported
    points are where the supports hold them.
    """

    turn: Floats
    shift: Floats
    star: Ints
    shift_in_space: Floats = field(default_factory=lambda: np.zeros(3))

    @property
    def mirrors(self) -> bool:
        """Whether it is a mirror, and not a rotation."""
        return bool(np.linalg.det(self.turn) < 0.0)

    def in_space(self, places: Floats) -> Floats:
        """(n, 3) mm, places of the image's points p, from those (n, 3) of the points `turn p + shift` of the shape."""
        moved = places - self.shift_in_space
        return np.hstack([moved[:, :2] @ self.turn, moved[:, 2:]])


def symmetries(design: Design, layout: Layout) -> list[Symmetry]:
    """All symmetries of the stars, their arms and sizes, the outline, the pins, the stretch and the weight.

    The identity comes first. Each maps the centre of the stars to itself, and the lattice onto itself but for a shift.
    Of a drawing, it maps the middle of the sheet to itself.
    """
    if layout.drawn is not None:
        return _of_drawing(design, layout)
    tolerance = SYMMETRY_TOLERANCE * layout.spacing_mm
    centre = layout.centres.mean(axis=0)
    # Tips may meet. A quarter of the way back to the centre, no two arms do.
    arm_points = cKDTree(layout.arm_tip + 0.25 * (layout.centres[layout.arm_star] - layout.arm_tip))
    # corners on a straight edge have no effect
    outline = layout.outline[np.abs(turning_angles(layout.outline)) > STRAIGHT_TURN_RAD]
    stars, corners, samples = cKDTree(layout.centres), cKDTree(outline), layout.support_samples
    kept = []
    for turn in _lattice_symmetries(layout.lattice_vectors):
        shift = centre - turn @ centre
        star = _image(layout.centres @ turn.T + shift, stars, tolerance)
        if star is None or not _keeps_directions(design, turn):
            continue
        if not _keeps_order(_image(outline @ turn.T + shift, corners, tolerance)):
            continue
        motion = Symmetry(turn, shift, star)
        shift_in_space = _support_shift(samples, motion, tolerance)
        # the edges of holes may be curves
        if not maps_holes(layout, turn, shift, tolerance + CURVE_TOLERANCES * IMPORT_CURVE_MM):
            continue
        if _keeps_arms(layout, arm_points, motion, tolerance) and shift_in_space is not None:
            kept.append(replace(motion, shift_in_space=shift_in_space))
    return kept


def _of_drawing(design: Design, layout: Layout) -> list[Symmetry]:
    """All symmetries of drawn rods; curves are as near to each other as they are to their straight pieces."""
    curve_mm = max(design.required_rods.curve_mm, IMPORT_CURVE_MM)
    tolerance = SYMMETRY_TOLERANCE * layout.spacing_mm + CURVE_TOLERANCES * curve_mm
    centre = shapely.get_coordinates(shapely.centroid(shapely.polygons(layout.outline)))[0]
    samples, centres = layout.support_samples, cKDTree(layout.centres) if layout.has_stars else None
    images = DrawingImages(layout, tolerance)
    kept = []
    for turn in candidate_turns(layout.graph, centre):
        star: Ints = np.empty(0, dtype=np.int64)
        if centres is not None:
            image = _image(layout.centres @ turn.T + centre - turn @ centre, centres, tolerance)
            if image is None:
                continue
            star = image
        motion = Symmetry(turn, centre - turn @ centre, star)
        shift_in_space = _support_shift(samples, motion, tolerance)
        if shift_in_space is None or not _keeps_directions(design, turn):
            continue
        if images.are_equal(turn, motion.shift):
            kept.append(replace(motion, shift_in_space=shift_in_space))
    return kept


def _lattice_symmetries(vectors: Floats) -> list[Floats]:
    """Orthogonal matrices that map the lattice onto itself, the identity first."""
    steps = np.stack(np.meshgrid(*2 * [np.arange(-3, 4)], indexing="ij"), axis=-1).reshape(-1, 2) @ vectors
    angle = np.arctan2(*vectors[0][::-1])
    length = np.linalg.norm(steps, axis=1)
    equal = steps[np.abs(length - np.linalg.norm(vectors[0])) < SYMMETRY_TOLERANCE * length.max()]
    matrices = []
    for target in np.sort(np.arctan2(equal[:, 1], equal[:, 0])):
        for mirror in (1.0, -1.0):
            c, s = np.cos(target - mirror * angle), np.sin(target - mirror * angle)
            turn = np.array([[c, -s], [s, c]]) @ np.diag([1.0, mirror])
            cells = vectors @ turn.T @ np.linalg.inv(vectors)
            if np.abs(cells - np.rint(cells)).max() < 1e-6:
                matrices.append(turn)
    return sorted(matrices, key=lambda turn: bool(np.abs(turn - np.eye(2)).max() > 1e-9))


def _image(moved: Floats, points: cKDTree, tolerance: float) -> Ints | None:
    """(n,) the point onto which each one is moved; None unless every point is the image of exactly one."""
    if points.n == 0:
        return np.empty(0, dtype=np.int64)
    index = points.query(moved, distance_upper_bound=tolerance)[1]  # n where no point is that close
    if index.max() == points.n or not np.bincount(index, minlength=points.n).all():
        return None
    return np.asarray(index, dtype=np.int64)


def _keeps_order(corner: Ints | None) -> bool:
    """Whether neighbouring corners stay neighbours: equal corners may be joined in another order."""
    if corner is None:
        return False
    step = (np.roll(corner, -1) - corner) % len(corner)
    return bool((step == 1).all() or (step == len(corner) - 1).all())


def _keeps_arms(layout: Layout, arm_points: cKDTree, motion: Symmetry, tolerance: float) -> bool:
    """Whether arms move onto arms of the same sizes; `arm_points` has one point an arm."""
    arm = _image(arm_points.data @ motion.turn.T + motion.shift, arm_points, tolerance)
    if arm is None or not np.array_equal(layout.arm_star[arm], motion.star[layout.arm_star]):
        return False
    sizes = (layout.arm_thickness, layout.arm_width)
    equal_sizes = all((np.abs(size[arm] - size) <= SYMMETRY_TOLERANCE * size).all() for size in sizes)
    tips = layout.arm_tip @ motion.turn.T + motion.shift
    return equal_sizes and bool(np.abs(tips - layout.arm_tip[arm]).max(initial=0.0) < tolerance)


def _support_shift(samples: SupportSamples, motion: Symmetry, tolerance: float) -> Floats | None:
    """(3,) mm by which the places of the supports shift in space; None if the supports are not mapped onto themselves.

    0 along directions in which the sheet slides at all supports.
    """
    printed, place, kind = samples
    if len(printed) == 0:
        return np.zeros(3)
    # a third coordinate keeps points of different kinds apart
    height = 10.0 * (1.0 + float(np.abs(printed).max())) * kind[:, None]
    points = cKDTree(np.hstack([printed, height]))
    image = _image(np.hstack([printed @ motion.turn.T + motion.shift, height]), points, tolerance)
    if image is None:
        return None
    moved = place.copy()
    moved[:, :2] = place[:, :2] @ motion.turn.T
    gap = place[image] - moved
    # in space the pins may have another centre than in print: one shift for all of them
    low, high = np.nanmin(gap, axis=0, initial=np.inf), np.nanmax(gap, axis=0, initial=-np.inf)
    if np.max(high - low) >= tolerance:
        return None
    return np.array([(a + b) / 2 if a <= b else 0.0 for a, b in zip(low, high, strict=True)])


def _keeps_directions(design: Design, turn: Floats) -> bool:
    """Whether the motion keeps the stretch along x and y, and the direction of gravity if it is on."""
    stretch = np.diag(design.fabric.stretch_xy)
    if np.abs(turn @ stretch - stretch @ turn).max() > SYMMETRY_TOLERANCE:
        return False
    pull = np.asarray(design.gravity.direction[:2]) / np.linalg.norm(design.gravity.direction)
    return not design.gravity.on or bool(np.abs(turn @ pull - pull).max() < SYMMETRY_TOLERANCE)
