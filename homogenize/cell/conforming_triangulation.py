"""A conforming Delaunay triangulation of a cell: given points and segments, and free points around them.

The free points begin as a triangular grid. Each sweep triangulates all points and moves the free ones to the mean
circumcentre of their triangles. Some sweeps also drop points that are too close to an arm or to each other, and add
points to large triangles. The best sweep is the result.

Free points come in orbits of the cell's point group, and only symmetric triangulations count.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.homogenize.cell.orbits import Orbits, home, in_one_domain, is_symmetric
from asterism.homogenize.cell.periodic_delaunay import CELLS_AROUND, PeriodicTriangles, periodic_delaunay
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_segment

MAX_SMOOTHING_SWEEPS = 40
# sweeps after which points are dropped and added
REFINEMENT_SWEEPS = range(3, 25, 3)
# distance of a free point from an arm, over the local edge length
MIN_ARM_DISTANCE_RATIO = 0.5
# distance of two points, over the local edge length
MIN_POINT_DISTANCE_RATIO = 0.6
# circumradius over the local edge length, above which a triangle gets a point; 0.58 for an equilateral triangle
MAX_CIRCUMRADIUS_RATIO = 0.85
# growth of the edges per distance from shorter ones on the arms
EDGE_GROWTH = 0.4
# smallest angle that ends the sweeps
GOOD_ANGLE_DEG = 35.0
# sweeps without a better smallest angle
MAX_IDLE_SWEEPS = 6
# margin around the cell in which images count, in edges
IMAGE_MARGIN_EDGES = 3.0
# a group without symmetries
IDENTITY: Floats = np.eye(2)[None]


@dataclass(frozen=True)
class MeshConstraints:
    """Points and segments that a mesh contains.

    Attributes
    ----------
    vectors : (2, 2) mm, lattice vectors as rows.
    points : (F, 2) mm, in the cell.
    size : (F,) mm, target length of the edges at the points.
    a, b, step : (E,), (E,), (E, 2) segments from point a to the image `step` of point b, at most one cell long.
    group : (G, 2, 2) rotations and reflections about the origin that keep points, segments and lattice; the identity
        first.
    wall_a, wall_b : (W, 2) mm, pieces of the mirror lines. Free points keep a distance from them.
    """

    vectors: Floats
    points: Floats
    size: Floats
    a: Ints
    b: Ints
    step: Ints
    group: Floats
    wall_a: Floats
    wall_b: Floats


def conforming_triangulation(frame: MeshConstraints, edge_mm: float) -> PeriodicTriangles:
    """Triangles of the given points, which come first, and of free ones with edges of about `edge_mm`.

    Raises
    ------
    MeshError
        No sweep has all segments as edges, and the symmetry of the group.
    """
    beside, vectors, group = _Beside(frame, edge_mm), frame.vectors, frame.group
    seeds = _grid(vectors, edge_mm)
    seeds = seeds[~beside.too_near(seeds)]
    seeds = seeds[in_one_domain(seeds, group, vectors)]
    best, best_angle, last = None, 0.0, REFINEMENT_SWEEPS.stop
    for sweep in range(MAX_SMOOTHING_SWEEPS):
        orbits = Orbits.of(seeds, group, vectors, edge_mm)
        triangulation = periodic_delaunay(np.vstack([frame.points, orbits.points]), vectors, edge_mm, group)
        mend = sweep in REFINEMENT_SWEEPS
        angle = float(triangulation.angles.min())
        if not mend and sweep > REFINEMENT_SWEEPS.start and angle > best_angle and _is_conforming(triangulation, frame):
            best, best_angle, last = triangulation, angle, max(sweep, last)
        if (
            best is not None
            and sweep > REFINEMENT_SWEEPS.stop
            and (best_angle > GOOD_ANGLE_DEG or sweep > last + MAX_IDLE_SWEEPS)
        ):
            break
        seeds = orbits.moved(triangulation.smoothed()[len(frame.points) :], group, vectors)
        if mend:
            seeds = np.vstack([seeds, _missing(beside, triangulation)])
            seeds = _mended(beside, seeds, group, vectors, edge_mm)
        seeds = home(seeds, vectors)
        seeds = seeds[~beside.too_near(seeds)]
    if best is None:
        raise MeshError("no mesh follows the arms: use a shorter edge")
    return best


def _grid(vectors: Floats, edge_mm: float) -> Floats:
    """(n, 2) mm, rows along A1; each is shifted by about half an edge, as far as periodicity permits."""
    along = float(np.linalg.norm(vectors[0]))
    height = abs(np.linalg.det(vectors)) / along
    n, rows = max(3, round(along / edge_mm)), max(3, round(height / (edge_mm * np.sqrt(0.75))))
    reach = float(vectors[1] @ vectors[0]) / along**2 * n  # of A2, in edges along A1
    shift = (round(round(0.5 * rows - reach, 9)) + reach) / rows
    j, i = (index.ravel() for index in np.indices((rows, n)))
    fraction = np.column_stack([(i + (shift - reach / rows) * j) / n, j / rows])
    return (fraction - np.floor(fraction + 1e-9)) @ vectors


def _copies(vectors: Floats, of: Floats) -> Floats:
    """(9 n, 2) points of the cell and of the eight cells around it; those of the cell are in the middle."""
    return np.asarray((of + (CELLS_AROUND @ vectors)[:, None]).reshape(-1, 2))


class _Beside:
    """The constraints, with their images near the cell."""

    def __init__(self, frame: MeshConstraints, edge_mm: float) -> None:
        self._edge_mm = edge_mm
        inverse = np.linalg.inv(frame.vectors)
        margin = 0.5 + IMAGE_MARGIN_EDGES * edge_mm * np.linalg.norm(inverse, axis=0)

        def near(places: Floats) -> Bools:
            return np.asarray((np.abs(places @ inverse - 0.5) < margin).all(axis=1))

        points, size = _copies(frame.vectors, frame.points), np.tile(frame.size, len(CELLS_AROUND))
        self._tree = cKDTree(points)
        short = near(points) & (size < edge_mm * (1.0 - 1e-9))
        self._points, self._size = points[short], size[short]
        a = _copies(frame.vectors, frame.points[frame.a])
        b = _copies(frame.vectors, frame.points[frame.b] + frame.step @ frame.vectors)
        known = near(a) | near(b)
        wall_a, wall_b = _copies(frame.vectors, frame.wall_a), _copies(frame.vectors, frame.wall_b)
        beside = near(wall_a) | near(wall_b)
        self._a, self._b = np.vstack([a[known], wall_a[beside]]), np.vstack([b[known], wall_b[beside]])

    def size(self, places: Floats) -> Floats:
        """(n,) mm, target length of the edges at places (n, 2) of the cell."""
        if not len(self._points):
            return np.full(len(places), self._edge_mm)
        distance = np.linalg.norm(places[:, None] - self._points, axis=2)
        return np.asarray(np.minimum((self._size + EDGE_GROWTH * distance).min(axis=1), self._edge_mm))

    def too_near(self, free: Floats) -> Bools:
        """(n,) whether points are close to an arm or a given point, or inside the circle over a segment."""
        size = self.size(free)
        near = np.asarray(self._tree.query(free)[0] < MIN_POINT_DISTANCE_RATIO * size)
        if len(self._a):
            near |= (distance_to_segment(free[:, None], self._a, self._b) < MIN_ARM_DISTANCE_RATIO * size[:, None]).any(
                axis=1
            )
            near |= (((free[:, None] - self._a) * (free[:, None] - self._b)).sum(axis=2) < 0.0).any(axis=1)
        return near


def _mended(beside: _Beside, seeds: Floats, group: Floats, vectors: Floats, edge_mm: float) -> Floats:
    """(n, 2) mm, seeds whose orbits keep a distance from themselves and from those before them."""
    seeds = home(seeds, vectors)
    near = MIN_POINT_DISTANCE_RATIO * beside.size(seeds)
    if len(group) > 1:
        seeds = home(Orbits.of(seeds, group, vectors, edge_mm).gathered(near, vectors), vectors)
    orbits = Orbits.of(seeds, group, vectors, edge_mm)
    return np.asarray(seeds[~_crowded(beside, vectors, orbits)])


def _crowded(beside: _Beside, vectors: Floats, orbits: Orbits) -> Bools:
    """(n,) True for the later one of two orbits that are too close, and for one too close to itself."""
    size = beside.size(orbits.points)
    n, copies = len(orbits.points), _copies(vectors, orbits.points)
    middle = len(CELLS_AROUND) // 2
    reach = MIN_POINT_DISTANCE_RATIO * float(size.max(initial=0.0))
    pairs = cKDTree(copies).query_pairs(reach, output_type="ndarray")
    out = np.zeros(len(orbits.seeds), dtype=bool)
    for one, other in pairs[np.lexsort(pairs.T[::-1])]:
        if middle not in (one // n, other // n):
            continue
        i, j = one % n, other % n
        p, q = sorted((int(orbits.orbit[i]), int(orbits.orbit[j])))
        if (
            i != j
            and not out[p]
            and np.linalg.norm(copies[one] - copies[other]) < MIN_POINT_DISTANCE_RATIO * min(size[i], size[j])
        ):
            out[q] = True
    return out


def _missing(beside: _Beside, triangulation: PeriodicTriangles) -> Floats:
    """(n, 2) mm, centres of triangles that are too large; a later step drops those that crowd."""
    middle = triangulation.places.reshape(-1, 3, 2).mean(axis=1)
    radius = np.linalg.norm(triangulation.circumcentres - triangulation.places[::3], axis=1)
    ratio = radius / beside.size(middle)
    large = np.flatnonzero(ratio > MAX_CIRCUMRADIUS_RATIO)
    places = middle[large[np.argsort(-ratio[large], kind="stable")]]
    return home(places, triangulation.vectors)


def _is_conforming(triangulation: PeriodicTriangles, frame: MeshConstraints) -> bool:
    """Whether every given segment is an edge, and the triangles have the symmetry of the group."""
    has_segments = np.isin(triangulation.name(frame.a, frame.b, frame.step), triangulation.edges()[0]).all()
    if not has_segments or len(frame.group) == 1:
        return bool(has_segments)
    middles = triangulation.places.reshape(-1, 3, 2).mean(axis=1)
    return is_symmetric(middles, frame.group, frame.vectors, float(frame.size.max()))
