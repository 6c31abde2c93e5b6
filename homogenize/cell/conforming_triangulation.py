"""Points of a cell around given ones: a triangular grid, thinned out beside arms, evened out and mended.

Every sweep triangulates, moves the free points to the mean circumcentres of their triangles, drops those that come too
close to an arm or to each other, and adds some where triangles are too large. The best sweep is kept.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from homogenize.cell.periodic_delaunay import PeriodicTriangles, periodic_delaunay
from pattern.design.errors import MeshError
from pattern.geometry.arrays import Bools, Floats, Ints
from pattern.geometry.planar import distance_to_segment

# sweeps in all, and those after which points are dropped and added
MAX_SMOOTHING_SWEEPS, REFINEMENT_SWEEPS = 40, range(3, 25, 3)
# in units of the local edge: nearer to an arm, or to another point, a point goes
MIN_ARM_DISTANCE_RATIO, MIN_POINT_DISTANCE_RATIO = 0.5, 0.6
# circumradius over the local edge, .58 of an equilateral triangle, from which a triangle gets a point
MAX_CIRCUMRADIUS_RATIO = 0.85
# growth of the edges away from shorter ones on the arms
EDGE_GROWTH = 0.4
# smallest angle that is good enough, or sweeps without a better one
GOOD_ANGLE_DEG, MAX_IDLE_SWEEPS = 35.0, 6
# edges around the cell within which images count
IMAGE_MARGIN_EDGES = 3.0
_STEPS = np.array([[i, j] for i in (-1, 0, 1) for j in (-1, 0, 1)])


@dataclass(frozen=True)
class MeshConstraints:
    """What a mesh must contain.

    Attributes
    ----------
    vectors : (2, 2) mm, rows.
    points : (F, 2) mm, in the cell.
    size : (F,) mm, wished length of the edges there.
    a, b, step : (E,), (E,), (E, 2) segments from a point to the image `step` of a point, no longer than the cell.
    """

    vectors: Floats
    points: Floats
    size: Floats
    a: Ints
    b: Ints
    step: Ints


def conforming_triangulation(frame: MeshConstraints, edge_mm: float) -> PeriodicTriangles:
    """Triangles of the frame's points, which come first, and of others with edges of about `edge_mm`.

    Raises
    ------
    MeshError
        The frame's segments cannot be edges.
    """
    beside = _Beside(frame, edge_mm)
    free = _grid(frame.vectors, edge_mm)
    free = free[~beside.too_near(free)]
    best, best_angle, last = None, 0.0, REFINEMENT_SWEEPS.stop
    for sweep in range(MAX_SMOOTHING_SWEEPS):
        points = np.vstack([frame.points, free])
        found = periodic_delaunay(points, frame.vectors, edge_mm)
        mend = sweep in REFINEMENT_SWEEPS
        angle = float(found.angles.min())
        if not mend and sweep > REFINEMENT_SWEEPS.start and angle > best_angle and _has_segments(found, frame):
            best, best_angle, last = found, angle, max(sweep, last)
        if (
            best is not None
            and sweep > REFINEMENT_SWEEPS.stop
            and (best_angle > GOOD_ANGLE_DEG or sweep > last + MAX_IDLE_SWEEPS)
        ):
            break
        free = found.smoothed()[len(frame.points) :]
        if mend:
            free = np.vstack([free, _missing(beside, found)])
            free = free[~_crowded(beside, frame.vectors, free)]
        free = _home(free, frame.vectors)
        free = free[~beside.too_near(free)]
    if best is None:
        raise MeshError("no mesh follows the arms: use a shorter edge")
    return best


def _grid(vectors: Floats, edge_mm: float) -> Floats:
    """(n, 2) mm, rows along A1, each half an edge further than the one before as nearly as the cell lets them."""
    along = float(np.linalg.norm(vectors[0]))
    height = abs(np.linalg.det(vectors)) / along
    n, rows = max(3, round(along / edge_mm)), max(3, round(height / (edge_mm * np.sqrt(0.75))))
    reach = float(vectors[1] @ vectors[0]) / along**2 * n  # of A2, in edges along A1
    shift = (round(0.5 * rows - reach) + reach) / rows
    j, i = (index.ravel() for index in np.indices((rows, n)))
    fraction = np.column_stack([(i + (shift - reach / rows) * j) / n, j / rows])
    return (fraction - np.floor(fraction + 1e-9)) @ vectors


def _copies(vectors: Floats, of: Floats) -> Floats:
    """(9 n, 2) points of the cell and around it; the cell itself lies in the middle."""
    return np.asarray((of + (_STEPS @ vectors)[:, None]).reshape(-1, 2))


def _home(places: Floats, vectors: Floats) -> Floats:
    """(n, 2) mm, the images of places that lie in the cell."""
    return np.asarray(places - np.floor(places @ np.linalg.inv(vectors) + 1e-9) @ vectors)


class _Beside:
    """The frame with its images near the cell."""

    def __init__(self, frame: MeshConstraints, edge_mm: float) -> None:
        self._edge_mm = edge_mm
        inverse = np.linalg.inv(frame.vectors)
        margin = 0.5 + IMAGE_MARGIN_EDGES * edge_mm * np.linalg.norm(inverse, axis=0)

        def near(places: Floats) -> Bools:
            return np.asarray((np.abs(places @ inverse - 0.5) < margin).all(axis=1))

        points, size = _copies(frame.vectors, frame.points), np.tile(frame.size, len(_STEPS))
        self._tree = cKDTree(points)
        short = near(points) & (size < edge_mm * (1.0 - 1e-9))
        self._points, self._size = points[short], size[short]
        a = _copies(frame.vectors, frame.points[frame.a])
        b = _copies(frame.vectors, frame.points[frame.b] + frame.step @ frame.vectors)
        known = near(a) | near(b)
        self._a, self._b = a[known], b[known]

    def size(self, places: Floats) -> Floats:
        """(n,) mm, wished length of the edges at places (n, 2) of the cell."""
        if not len(self._points):
            return np.full(len(places), self._edge_mm)
        distance = np.linalg.norm(places[:, None] - self._points, axis=2)
        return np.asarray(np.minimum((self._size + EDGE_GROWTH * distance).min(axis=1), self._edge_mm))

    def too_near(self, free: Floats) -> Bools:
        """(n,) which points lie beside an arm, on a point of the frame, or within the circle over a segment."""
        size = self.size(free)
        near = np.asarray(self._tree.query(free)[0] < MIN_POINT_DISTANCE_RATIO * size)
        if len(self._a):
            near |= (distance_to_segment(free[:, None], self._a, self._b) < MIN_ARM_DISTANCE_RATIO * size[:, None]).any(
                axis=1
            )
            near |= (((free[:, None] - self._a) * (free[:, None] - self._b)).sum(axis=2) < 0.0).any(axis=1)
        return near


def _crowded(beside: _Beside, vectors: Floats, free: Floats) -> Bools:
    """(n,) of two free points that are too close, the later one."""
    size = beside.size(free)
    n, copies = len(free), _copies(vectors, free)
    middle = len(_STEPS) // 2
    pairs = cKDTree(copies).query_pairs(MIN_POINT_DISTANCE_RATIO * float(size.max()), output_type="ndarray")
    out = np.zeros(n, dtype=bool)
    for one, other in pairs[np.lexsort(pairs.T[::-1])]:
        if middle not in (one // n, other // n):
            continue
        p, q = sorted((one % n, other % n))
        if (
            p != q
            and not out[p]
            and np.linalg.norm(copies[one] - copies[other]) < MIN_POINT_DISTANCE_RATIO * min(size[p], size[q])
        ):
            out[q] = True
    return out


def _missing(beside: _Beside, found: PeriodicTriangles) -> Floats:
    """(n, 2) mm, the centres of triangles that are too large; those that crowd are dropped afterwards."""
    middle = found.places.reshape(-1, 3, 2).mean(axis=1)
    radius = np.linalg.norm(found.circumcentres - found.places[::3], axis=1)
    ratio = radius / beside.size(middle)
    large = np.flatnonzero(ratio > MAX_CIRCUMRADIUS_RATIO)
    places = middle[large[np.argsort(-ratio[large], kind="stable")]]
    return _home(places, found.vectors)


def _has_segments(found: PeriodicTriangles, frame: MeshConstraints) -> bool:
    """Whether every segment of the frame is an edge."""
    return bool(np.isin(found.name(frame.a, frame.b, frame.step), found.edges()[0]).all())
