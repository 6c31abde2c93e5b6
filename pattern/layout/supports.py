"""Supports of the sheet: which printed places are supported, in which directions, and where they stand in space.

A `PinSet` answers the questions that meshes, models, drawings and needles ask. So a new kind of pin is defined here and
in `pattern.layout.pin_placement`. Of its users, only `pattern.layout.symmetries` has to know which directions it holds.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import STRAIGHT_TURN_RAD, nearest_segment, turning_angles
from asterism.pattern.layout.sheet_edges import SheetEdges

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

# Which of x, y, z are supported, by the value of `slide` in the design file.
FIXED_BY_SLIDE = {None: (True, True, True), "z": (True, True, False), "plane": (False, False, True)}


@dataclass(frozen=True, eq=False)
class SupportCurve:
    """The curve in space along which a chain of supported edges of the outline is held.

    The design gives a place in space for each corner. The curve is the best affine image of the printed edges plus a
    shift, which interpolates what remains at the corners by cubic splines over the printed length. So places that are
    an affine image of the corners give exactly that image of the edges. Splines end at sharp corners.

    Corners on a line, or nearly, do not tell where the arcs between them stand out to. Then the image is a similar one
    that stands out horizontally.
    """

    corners: Floats  # (k, 2) mm, printed corners along the chain; a closed chain ends with its first corner
    stations: Floats  # (k,) mm, printed length from the first corner
    # matrix, offset: (3, 2) and (3,) mm of the affine image.
    matrix: Floats
    offset: Floats
    shifts: tuple[CubicSpline, ...]  # splines of the rest (3,) mm over the stations, one for each smooth stretch
    ends: Floats  # (s + 1,) stations at which the stretches begin, and the last end

    @classmethod
    def through(cls, corners: Floats, places: Floats, given: Ints | None = None) -> SupportCurve:
        """The curve through places (g, 3) mm of corners (k, 2) mm; both end with the first row if it is closed.

        `given`: (g,) numbers of the corners that have a place, the first and the last among them; by default all.

        >>> corners = np.array([[0.0, 0.0], [10.0, 0.0], [20.0, 0.0]])
        >>> curve = SupportCurve.through(corners, np.column_stack([0.8 * corners, [0.0, 3.0, 0.0]]))
        >>> curve.places(np.array([[5.0, 0.0]])).round(3).tolist()
        [[4.0, 0.0, 2.25]]
        """
        from scipy.interpolate import CubicSpline  # slow to import; designs without such curves do without it

        is_closed = np.array_equal(corners[0], corners[-1])
        given = np.arange(len(corners)) if given is None else given
        stations = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
        held, knots = corners[given], stations[given]
        centre = held.mean(axis=0)
        terms = np.column_stack([held - centre, np.ones(len(held))])
        fitted = np.linalg.lstsq(terms, places, rcond=None)[0]
        # an affine image of narrow corners would magnify what the arcs between them stand out by
        if np.ptp(_across(held, held)) < 0.3 * np.ptp(_across(held, corners)):
            fitted[:2] = _similar(held, places)
        matrix = fitted[:2].T
        rest = places - terms @ fitted
        rest[np.abs(rest) < 1e-9 * (1.0 + np.abs(places).max())] = 0.0
        sharp = _sharp(corners, is_closed)[given]
        if is_closed and not sharp[0]:
            if not sharp.any():
                shifts = (CubicSpline(knots, rest, bc_type="periodic"),)
                return cls(corners, stations, matrix, fitted[2] - matrix @ centre, shifts, stations[[0, -1]])
            # the stretch that goes through the first corner is interpolated over both of its parts
            first = int(np.flatnonzero(sharp)[0])
            corners, places = (
                np.concatenate([each[at:-1], each[: at + 1]]) for each, at in ((corners, given[first]), (places, first))
            )
            given = np.append(np.sort((given[:-1] - given[first]) % (len(corners) - 1)), len(corners) - 1)
            return cls.through(corners, places, given)
        breaks = np.unique([0, *np.flatnonzero(sharp), len(given) - 1])
        shifts = tuple(CubicSpline(knots[a : b + 1], rest[a : b + 1]) for a, b in itertools.pairwise(breaks))
        return cls(corners, stations, matrix, fitted[2] - matrix @ centre, shifts, knots[breaks])

    def places(self, printed: Floats) -> Floats:
        """(n, 3) mm, places of printed points (n, 2) on the edges."""
        return np.asarray(printed @ self.matrix.T + self.offset + self._shift(self._edges(printed), printed)[:, 0])

    def shift(self, points: Floats, middles: Floats, tangents: Floats) -> Floats:
        """(n, 3, 3) mm: the shift from the affine image, and its first and second derivative along the printed edge.

        Parameters
        ----------
        points : (n, 2) mm, on the edges.
        middles : (n, 2) mm, of the mesh edges of the points: at a sharp corner they tell the stretch.
        tangents : (n, 2) unit vectors along which the derivatives are taken.
        """
        edges = self._edges(middles)
        along = self.corners[edges + 1] - self.corners[edges]
        sense = np.sign(np.einsum("ni,ni->n", along, tangents))
        return self._shift(edges, points) * np.stack([np.ones_like(sense), sense, np.ones_like(sense)], 1)[:, :, None]

    def _edges(self, points: Floats) -> Ints:
        """(n,) the nearest edge of each point."""
        if not len(points):
            return np.empty(0, dtype=np.int64)
        return np.asarray(nearest_segment(points, self.corners[:-1], self.corners[1:]))

    def _shift(self, edges: Ints, points: Floats) -> Floats:
        """(n, 3, 3) shift and its derivatives at points (n, 2), on the stretches of these edges."""
        middle = 0.5 * (self.stations[edges] + self.stations[edges + 1])
        stretch = np.searchsorted(self.ends, middle) - 1
        result = np.zeros((len(points), 3, 3))
        for number, spline in enumerate(self.shifts):
            its = np.flatnonzero(stretch == number)
            if len(its):
                station = np.clip(self._stations(points[its], number), *self.ends[[number, number + 1]])
                result[its] = np.stack([spline(station, order) for order in range(3)], axis=1)
        return result

    def _stations(self, points: Floats, stretch: int) -> Floats:
        """(n,) mm, stations of the nearest places to points (n, 2) on a stretch."""
        first, last = np.searchsorted(self.stations, self.ends[[stretch, stretch + 1]])
        line = shapely.linestrings(self.corners[first : last + 1])
        return np.asarray(self.stations[first] + shapely.line_locate_point(line, shapely.points(points)))


def _direction(points: Floats) -> Floats:
    """(2,) unit vector of the line that is nearest to points (n, 2)."""
    return np.asarray(np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0])


def _across(held: Floats, points: Floats) -> Floats:
    """(n,) mm, distances of points (n, 2) to the left of the line that is nearest to other ones."""
    x, y = _direction(held)
    return np.asarray((points - held.mean(axis=0)) @ [-y, x])


def _similar(held: Floats, places: Floats) -> Floats:
    """(2, 3) images of the unit vectors along x and y: similar ones of points (n, 2) nearly on a line."""
    along = _direction(held)
    station = (held - held.mean(axis=0)) @ along
    image = station @ (places - places.mean(axis=0)) / (station @ station)
    left, level = np.array([-image[1], image[0], 0.0]), np.hypot(*image[:2])
    out = left * np.linalg.norm(image) / level if level > 0.0 else left
    return np.outer(along, image) + np.outer([-along[1], along[0]], out)


def _sharp(corners: Floats, is_closed: bool) -> np.ndarray:
    """(k,) whether each corner (k, 2) of a chain is sharp; both ends only if it is closed."""
    # the curve may have a kink where the outline turns by more
    sharp = np.abs(turning_angles(corners[:-1] if is_closed else corners)) > np.radians(30.0)
    if is_closed:
        return np.append(sharp, sharp[0])
    sharp[[0, -1]] = False
    return sharp


@dataclass(frozen=True)
class PinSet:
    """Places of the sheet that are all supported in the same way.

    >>> pins = PinSet(np.array([[10.0, -20.0]]), (), FIXED_BY_SLIDE["z"], scale=0.5)
    >>> pins.places(pins.points).tolist()
    [[5.0, -10.0, 0.0]]
    >>> pins.holds_in_plane, pins.slide
    (True, 'z')
    """

    points: Floats  # (P, 2) mm, single printed points (corners of the outline included)
    # edges of the outline and of holes that are supported along their whole length, numbered as in `SheetEdges`.
    edges: tuple[int, ...]
    fixed: tuple[bool, bool, bool]  # which of x, y, z are supported. The sheet slides freely along the others.
    scale: float = 1.0  # x and y are held at `scale` times the printed place (about the origin of the print), z at 0
    offset_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)  # added to the place given by `scale`
    # places in space, (P, 3), one a point, or one for each corner along the edges; in place of `scale` and `offset_mm`.
    target_mm: Floats | None = None
    step: int = 0  # 0 supports the sheet during its release; 1, 2, ... move the released sheet, in this order.
    # through the targets of edges; None for points, and for edges with `scale` and `offset_mm`.
    curve: SupportCurve | None = None

    @property
    def holds_in_plane(self) -> bool:
        """Whether x or y is supported."""
        return self.fixed[0] or self.fixed[1]

    @property
    def holds_height(self) -> bool:
        """Whether z is supported."""
        return self.fixed[2]

    @property
    def slide(self) -> str | None:
        """`z` or `plane` where the sheet is free to slide, None if it is not."""
        return next(slide for slide, fixed in FIXED_BY_SLIDE.items() if fixed == self.fixed)

    @property
    def directions(self) -> Floats:
        """(k, 3) unit vectors of the supported directions."""
        return np.eye(3)[list(self.fixed)]

    @property
    def affine_motion(self) -> tuple[Floats, Floats]:
        """Matrix (3, 2) and shift (3,) mm from printed points to their places, or to the affine image of a curve."""
        if self.curve is not None:
            return self.curve.matrix, self.curve.offset
        return self.scale * np.eye(3)[:, :2], np.asarray(self.offset_mm, dtype=float)

    def places(self, printed: Floats) -> Floats:
        """(n, 3) mm, places in space of the printed points (n, 2); only the components in `fixed` count.

        With `target_mm` for points, `printed` must be `points`; for edges, it must be on them.
        """
        if self.curve is not None:
            return self.curve.places(printed)
        if self.target_mm is not None:
            return np.asarray(self.target_mm, dtype=float)
        flat = np.column_stack([self.scale * printed, np.zeros(len(printed))])
        return np.asarray(flat + np.asarray(self.offset_mm))

    def holds_as(self, other: PinSet) -> bool:
        """Whether another set holds the same points and edges in the same directions, from the same step on."""
        same = (self.edges, self.fixed, self.step) == (other.edges, other.fixed, other.step)
        return same and np.array_equal(self.points, other.points)

    def stands_as(self, other: PinSet) -> bool:
        """Whether another set that holds the same points holds them at the same places in space."""
        if self.target_mm is None or other.target_mm is None:
            same = (self.scale, self.offset_mm) == (other.scale, other.offset_mm)
            return same and self.target_mm is other.target_mm
        return np.array_equal(self.target_mm, other.target_mm)

    def is_active(self, step: int) -> bool:
        """Whether these pins support the sheet in a step."""
        return self.step <= step

    def chains(self, sheet: SheetEdges) -> list[list[int]]:
        """Corners along edges that follow each other, chain by chain.

        A chain all around the outline or a hole ends with its first corner.

        >>> hexagon = SheetEdges.of(np.array([[2, 0], [1, 2], [-1, 2], [-2, 0], [-1, -2], [1, -2]]))
        >>> PinSet(np.empty((0, 2)), (5, 0, 2), FIXED_BY_SLIDE[None]).chains(hexagon)
        [[5, 0, 1], [2, 3]]
        """
        left = set(self.edges)
        chains = []
        for first in [*(edge for edge in self.edges if int(sheet.preceding[edge]) not in left), *self.edges]:
            chain = [first]
            while chain[-1] in left:
                left.remove(chain[-1])
                chain.append(int(sheet.following[chain[-1]]))
            if len(chain) > 1:
                chains.append(chain)
        return chains

    def segments(self, sheet: SheetEdges) -> Iterator[tuple[Floats, Floats]]:
        """Both ends (2,) mm of every edge."""
        for edge in self.edges:
            yield sheet.start[edge], sheet.end[edge]

    def straight_stretches(self, sheet: SheetEdges) -> list[Floats]:
        """(2, 2) mm, both ends of every straight stretch of edges; there may be corners on a stretch."""
        held = set(self.edges)
        continues = np.abs(sheet.turns) <= STRAIGHT_TURN_RAD  # at corner i, from the edge before to edge i
        stretches = []
        for edge in self.edges:
            if continues[edge] and int(sheet.preceding[edge]) in held:
                continue
            last = edge
            while continues[following := int(sheet.following[last])] and following in held:
                last = following
            stretches.append(np.array([sheet.start[edge], sheet.end[last]]))
        return stretches


def all_points(pins: Sequence[PinSet]) -> Floats:
    """(P, 2) mm, the single points of several pin sets, one set after the other."""
    return np.concatenate([np.empty((0, 2)), *(pin.points for pin in pins)])


class SupportSamples(NamedTuple):
    """Places at which supports act."""

    printed: Floats  # (P, 2) mm
    places: Floats  # (P, 3) mm in space, not a number along directions in which the sheet slides
    kind: Ints  # (P,) equal for points of equal directions, step and shape (point or edge)


def sample_supports(pins: Sequence[PinSet], edges: SheetEdges) -> SupportSamples:
    """Of pins all single points, and both ends and the middle of every straight stretch of supported edges.

    Places are affine along an edge. So the samples of a stretch determine all of its places. Edges on a curve are
    sampled one by one.
    """
    printed, places, kinds = [np.empty((0, 2))], [np.empty((0, 3))], [np.empty(0, dtype=np.int64)]
    for pin in pins:
        fixed = np.asarray(pin.fixed)
        kind = 2 * int(fixed @ [1, 2, 4]) + 20 * pin.step
        stretches = pin.straight_stretches(edges) if pin.curve is None else pin.segments(edges)
        along = [np.vstack([*ends, np.mean(ends, axis=0)]) for ends in stretches]
        for points, kind_of_points in [(pin.points, kind), *((edge, kind + 1) for edge in along)]:
            if len(points):
                printed.append(points)
                places.append(np.where(fixed, pin.places(points), np.nan))
                kinds.append(np.full(len(points), kind_of_points))
    all_printed, all_kinds = np.concatenate(printed), np.concatenate(kinds)
    if len(all_printed) == 0:
        return SupportSamples(all_printed, places[0], all_kinds)
    # neighbouring edges share a corner
    _, first = np.unique(np.round(np.column_stack([all_printed, all_kinds]), 6), axis=0, return_index=True)
    return SupportSamples(all_printed[first], np.concatenate(places)[first], all_kinds[first])
