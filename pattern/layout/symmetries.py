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
from asterism.pattern.geometry.planar import clusters
from asterism.pattern.layout.free_motions import FreeMotions
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.supports import SupportSamples
from asterism.pattern.rods.graph import RodGraph

# of the spacing, or of a size: equal but for rounding
SYMMETRY_TOLERANCE = 1e-6
# two curves that are equal are apart by at most this many of the distances from their straight pieces
CURVE_TOLERANCES = 4.0
# highest order of a rotation that is looked for; a circle has all of them
MAX_ROTATION_ORDER = 12
# a moment below this part of its largest possible value is zero
ZERO_MOMENT = 1e-4


@dataclass(frozen=True)
class Symmetry:
    """A motion `p -> turn p + shift` of the print that maps it onto itself.

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
    """All symmetries of the rods and their sections, the outline, the holes, the pins, the fabric and the weight.

    The identity comes first. Each maps the middle of the outline to itself, and stars onto stars.
    """
    pattern = _Pattern(design, layout)
    stars, samples, kept = cKDTree(layout.centres), layout.support_samples, []
    for turn in _candidate_turns(layout.graph, pattern.centre):
        if not _keeps_directions(design, turn):
            continue
        shift = pattern.centre - turn @ pattern.centre
        star = _image(layout.centres @ turn.T + shift, stars, pattern.tolerance)
        if star is None:
            continue
        motion = Symmetry(turn, shift, star)
        shift_in_space = _support_shift(samples, motion, pattern.tolerance)
        if shift_in_space is not None and pattern.is_kept_by(motion):
            kept.append(replace(motion, shift_in_space=shift_in_space))
    return kept


def _image(moved: Floats, points: cKDTree, tolerance: float) -> Ints | None:
    """(n,) the point onto which each one is moved; None unless every point is the image of exactly one."""
    if points.n == 0:
        return np.empty(0, dtype=np.int64)
    index = points.query(moved, distance_upper_bound=tolerance)[1]  # n where no point is that close
    if index.max() == points.n or not np.bincount(index, minlength=points.n).all():
        return None
    return np.asarray(index, dtype=np.int64)


class _Pattern:
    """What is printed, and the edges of the sheet, for checks whether motions map them onto themselves."""

    def __init__(self, design: Design, layout: Layout) -> None:
        graph, rods, drawing = layout.graph, layout.graph.rods, design.rods
        self.centre = shapely.get_coordinates(shapely.centroid(shapely.polygons(layout.outline)))[0]
        # curves are as near to each other as they are to their straight pieces
        curve_mm = 0.0 if drawing is None else max(drawing.curve_mm, IMPORT_CURVE_MM)
        even = SYMMETRY_TOLERANCE * layout.spacing_mm
        self.tolerance = even + CURVE_TOLERANCES * curve_mm
        # sections of curves are evaluated at slightly different places
        self._same_section = SYMMETRY_TOLERANCE if drawing is None else 1e-3
        self._edges = shapely.multilinestrings([shapely.linearrings(ring) for ring in layout.edges.rings])
        # the edges of holes may be curves also on sheets of stars
        off = [self.tolerance, *[even + CURVE_TOLERANCES * max(curve_mm, IMPORT_CURVE_MM)] * len(layout.holes)]
        self._band = shapely.union_all(shapely.buffer(shapely.get_parts(self._edges), off))
        shapely.prepare(self._band)
        self._lines = graph.lines
        self._tree = shapely.STRtree(self._lines)
        ends = np.bincount([node for rod in rods for node in (rod.start, rod.end)], minlength=len(graph.nodes))
        # a rod above and one below may end at one place
        self._free_ends = cKDTree(clusters(graph.nodes[ends == 1], self.tolerance)[1])
        # all rods, one after the other with gaps, on one line of stations
        lengths = shapely.length(self._lines)
        self._first = np.cumsum(lengths + 1.0) - lengths
        self._stations = np.concatenate([first + rod.arc_lengths for first, rod in zip(self._first, rods, strict=True)])
        self._sections = [np.concatenate([getattr(rod, key) for rod in rods]) for key in ("thickness", "width")]
        self._plastic = np.array([(np.inf if rod.kappa_bar is None else rod.kappa_bar, rod.side) for rod in rods])
        # a rod is compared at four inner points, and a curve at as many as it has points
        count = [max(4, len(rod.points)) for rod in rods]
        self._rod = np.repeat(np.arange(len(rods)), count)
        self._along = np.concatenate([(np.arange(n) + 0.5) / n for n in count]) * lengths[self._rod]
        places = shapely.line_interpolate_point(self._lines[self._rod], self._along)
        self._samples = shapely.get_coordinates(places)

    def is_kept_by(self, motion: Symmetry) -> bool:
        """Whether a motion maps the edges of the sheet onto each other, and rods onto rods of equal sections."""

        def moved(points: Floats) -> Floats:
            return points @ motion.turn.T + motion.shift

        if not shapely.covers(self._band, shapely.transform(self._edges, moved)):
            return False
        if _image(moved(self._free_ends.data), self._free_ends, self.tolerance) is None:
            return False
        places = shapely.points(moved(self._samples))
        at, image = self._tree.query(places, predicate="dwithin", distance=self.tolerance)
        rod = self._rod[at]
        here = self._first[rod] + self._along[at]
        there = self._first[image] + shapely.line_locate_point(self._lines[image], places[at])
        equal = (self._plastic[image] == self._plastic[rod]).all(axis=1)
        for values in self._sections:
            one, other = np.interp([here, there], self._stations, values)
            equal &= np.abs(one - other) <= self._same_section * one
        return bool(np.bincount(at[equal], minlength=len(places)).all())


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
