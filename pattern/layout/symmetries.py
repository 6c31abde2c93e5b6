"""Rotations and mirrors of the print that map the whole design onto itself, and distances of shapes up to them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.design import Design
from asterism.pattern.design.drawings import IMPORT_CURVE_MM
from asterism.pattern.geometry.planar import STRAIGHT_TURN_RAD, turning_angles
from asterism.pattern.layout.free_motions import FreeMotions
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.supports import SupportSamples
from asterism.pattern.rods.graph import Rod, RodGraph

# of the spacing, or of a size: equal but for rounding
SYMMETRY_TOLERANCE = 1e-6
# two curves that are equal are apart by at most this many of the distances from their straight pieces
CURVE_TOLERANCES = 4.0
# highest order of a rotation that is looked for; a circle has all of them
MAX_ROTATION_ORDER = 12
# a moment below this part of its largest possible value is zero
ZERO_MOMENT = 1e-4
# inner points of a rod at which it is compared; a point every this many of its points for long curves
MIN_ROD_SAMPLES = 7
# relative difference of sections that are equal: those of curves are evaluated at slightly different places
SAME_SECTION = 1e-3
_SIZES = ("thickness", "width")


@dataclass(frozen=True)
class Symmetry:
    """A motion `p -> turn p + shift` of the print that maps it onto itself.

    Notes
    -----
    If `x(p)` is an equilibrium, so is the shape `x'(p) = Q x(turn p + shift)`. Q is any proper rotation if `turn` is
    one. A mirror puts the plastic on the wrong side of the print. So for a mirror Q must be improper: the shape is
    reflected in space too, which leaves its energy unchanged. Of these shapes `in_space` gives the one whose supported
    points are where the supports hold them.
    """

    turn: Floats  # (2, 2) orthogonal matrix; a mirror if its determinant is -1
    shift: Floats  # (2,) mm
    star: Ints  # (S,) the star onto which each star is moved; empty for a drawing without stars
    # (3,) mm, of the supports' places, which may have another centre than the print.
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
    """All symmetries of the stars, their arms and sizes, the outline, the pins, the fabric and the weight.

    The identity comes first. Each maps the centre of the stars to itself, and the lattice onto itself but for a shift.
    Of a drawing, it maps the middle of the sheet to itself.
    """
    if layout.drawn is None:
        tolerance = SYMMETRY_TOLERANCE * layout.spacing_mm
        centre, turns = layout.centres.mean(axis=0), _lattice_symmetries(layout.lattice_vectors)
        images: _StarImages | DrawingImages = _StarImages(layout, tolerance)
    else:
        # curves are as near to each other as they are to their straight pieces
        curve_mm = max(design.required_rods.curve_mm, IMPORT_CURVE_MM)
        tolerance = SYMMETRY_TOLERANCE * layout.spacing_mm + CURVE_TOLERANCES * curve_mm
        centre = shapely.get_coordinates(shapely.centroid(shapely.polygons(layout.outline)))[0]
        turns, images = _candidate_turns(layout.graph, centre), DrawingImages(layout, tolerance)
    stars, samples, kept = cKDTree(layout.centres), layout.support_samples, []
    for turn in turns:
        shift = centre - turn @ centre
        star = _image(layout.centres @ turn.T + shift, stars, tolerance)
        if star is None or not np.array_equal(layout.star_side[star], layout.star_side):
            continue
        if not _keeps_directions(design, turn):
            continue
        motion = Symmetry(turn, shift, star)
        shift_in_space = _support_shift(samples, motion, tolerance)
        if shift_in_space is not None and images.are_equal(motion):
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


class _StarImages:
    """Checks whether motions that map the stars onto themselves map arms, outline and holes onto themselves."""

    def __init__(self, layout: Layout, tolerance: float) -> None:
        self._layout, self._tolerance = layout, tolerance
        # Tips may meet. A quarter of the way back to the centre, no two arms do.
        self._arms = cKDTree(layout.arm_tip + 0.25 * (layout.centres[layout.arm_star] - layout.arm_tip))
        # corners on a straight edge have no effect
        self._corners = cKDTree(layout.outline[np.abs(turning_angles(layout.outline)) > STRAIGHT_TURN_RAD])

    def are_equal(self, motion: Symmetry) -> bool:
        """Whether a motion maps outline, holes and arms of equal sizes onto each other."""
        layout, tolerance = self._layout, self._tolerance
        if not _keeps_order(_image(self._corners.data @ motion.turn.T + motion.shift, self._corners, tolerance)):
            return False
        # the edges of holes may be curves
        if not _maps_holes(layout, motion, tolerance + CURVE_TOLERANCES * IMPORT_CURVE_MM):
            return False
        arm = _image(self._arms.data @ motion.turn.T + motion.shift, self._arms, tolerance)
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
    """Whether the motion keeps the fabric's stretch and grain, and the direction of gravity if it is on."""
    if not design.fabric.keeps(turn):
        return False
    pull = np.asarray(design.gravity.direction[:2]) / np.linalg.norm(design.gravity.direction)
    return not design.gravity.on or bool(np.abs(turn @ pull - pull).max() < SYMMETRY_TOLERANCE)


def _candidate_turns(graph: RodGraph, centre: Floats) -> list[Floats]:
    """Orthogonal matrices (2, 2) of all motions about a centre that can map the rods onto themselves.

    The identity is the first.

    Notes
    -----
    A rotation by an angle a multiplies the moment `m_k`, the integral of `(x + iy)^k` over the rods, by `exp(ika)`, and
    a mirror about an axis at b conjugates it and multiplies by `exp(2ikb)`. The first moment that is not zero allows k
    rotations and k axes.
    """
    ends = np.concatenate([np.stack([rod.points[:-1], rod.points[1:]], axis=1) for rod in graph.rods]) - centre
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    # Gauss points of the straight pieces
    parts, weights = np.polynomial.legendre.leggauss(MAX_ROTATION_ORDER // 2 + 1)
    places = (1 - parts[:, None, None]) / 2 * ends[:, 0] + (1 + parts[:, None, None]) / 2 * ends[:, 1]
    z, share = places[..., 0] + 1j * places[..., 1], weights[:, None] / 2 * length
    z = z / np.abs(z).max()
    moments = [(share * z**k).sum() / (share * np.abs(z) ** k).sum() for k in range(1, MAX_ROTATION_ORDER + 1)]
    order = next((k for k, m in enumerate(moments, 1) if abs(m) > ZERO_MOMENT), MAX_ROTATION_ORDER)
    axis = np.angle(moments[order - 1]) / order if abs(moments[order - 1]) > ZERO_MOMENT else 0.0
    turns = [_rotation(2 * np.pi * k / order) for k in range(order)]
    return turns + [_rotation(2 * (axis + np.pi * k / order)) @ np.diag([1.0, -1.0]) for k in range(order)]


class DrawingImages:
    """Checks whether motions map a drawing onto itself.

    Parameters
    ----------
    layout : of the drawing.
    tolerance : mm, distance within which lines are equal.
    """

    def __init__(self, layout: Layout, tolerance: float) -> None:
        self._layout, self._tolerance = layout, tolerance
        self._border = shapely.LinearRing(layout.outline)
        self._on_border = shapely.get_coordinates(shapely.segmentize(self._border, layout.spacing_mm))
        rods = layout.graph.rods
        counts = (max(MIN_ROD_SAMPLES, len(rod.points)) for rod in rods)
        self._parts = [(np.arange(count) + 0.5) / count for count in counts]  # of the lengths, without the ends
        self._points = np.concatenate([rod.at(rod.points, parts) for rod, parts in zip(rods, self._parts, strict=True)])
        self._lines = layout.graph.lines
        self._tree = shapely.STRtree(self._lines)
        sections = {(rod.kappa_bar, *np.unique(np.stack([rod.thickness, rod.width]), axis=1).ravel()) for rod in rods}
        self._has_one_section = len(sections) == 1 and len(next(iter(sections))) == 1 + len(_SIZES)

    def are_equal(self, motion: Symmetry) -> bool:
        """Whether a motion maps outline, holes and rods of equal sections onto each other."""
        turn, shift = motion.turn, motion.shift
        moved_border = shapely.points(self._on_border @ turn.T + shift)
        if (shapely.distance(self._border, moved_border) > self._tolerance).any():
            return False
        if not _maps_holes(self._layout, motion, self._tolerance):
            return False
        moved = shapely.points(self._points @ turn.T + shift)
        image = self._tree.nearest(moved)
        if (shapely.distance(self._lines[image], moved) > self._tolerance).any():
            return False
        if self._has_one_section:
            return True
        along = shapely.line_locate_point(self._lines[image], moved)
        rods, ends = self._layout.graph.rods, np.cumsum([len(parts) for parts in self._parts])[:-1]
        groups = zip(rods, self._parts, np.split(image, ends), np.split(along, ends), strict=True)
        for rod, parts, images, places in groups:
            for number in np.unique(images):
                here, other = images == number, rods[number]
                if not _same_sections(rod, parts[here], other, places[here] / other.length):
                    return False
        return True


def _maps_holes(layout: Layout, motion: Symmetry, tolerance: float) -> bool:
    """Whether a motion maps the holes onto holes, each edge within `tolerance` (mm)."""
    rings = [shapely.LinearRing(hole) for hole in layout.holes]
    for ring in rings:
        at = shapely.get_coordinates(shapely.segmentize(ring, layout.spacing_mm))
        moved = shapely.points(at @ motion.turn.T + motion.shift)
        if not any((shapely.distance(other, moved) <= tolerance).all() for other in rings):
            return False
    return True


def _same_sections(first: Rod, parts: Floats, second: Rod, other_parts: Floats) -> bool:
    if first.kappa_bar != second.kappa_bar:
        return False
    pairs = [(first.at(getattr(first, key), parts), second.at(getattr(second, key), other_parts)) for key in _SIZES]
    return all((np.abs(one - two) <= SAME_SECTION * one).all() for one, two in pairs)


def _rotation(angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def distances_of_images(
    printed: Floats,
    first: Floats,
    second_at: Callable[[Floats], Floats],
    symmetries: Sequence[Symmetry],
    free: FreeMotions,
) -> Floats:
    """(n,) mm, rms distance of two shapes after the best free motion, for each of n symmetries.

    Parameters
    ----------
    printed : (P, 2) mm, points at which they are compared.
    first : (P, 3) mm, their places in the first shape.
    second_at : gives the places (P, 3) of printed points in the second shape.
    symmetries : each stands for the image `x'(p) = Q x(turn p + shift)` of the second shape, see `Symmetry`.
    free : motions that the supports leave to the first shape.
    """
    distances = []
    for each in symmetries:
        image = each.in_space(second_at(printed @ each.turn.T + each.shift))
        rotation, shift = free.fit(first, image)
        distances.append(np.sqrt(((first @ rotation.T + shift - image) ** 2).sum(axis=1).mean()))
    return np.array(distances)
