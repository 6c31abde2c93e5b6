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
from asterism.homogenize.cell.periodic_mesh import CELLS_AROUND, PeriodicTriangles, periodic_delaunay
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_segment

# sweeps after which points are dropped and added
REFINEMENT_SWEEPS = range(3, 25, 3)
# distance of two points, over the local edge length
MIN_POINT_DISTANCE_RATIO = 0.6
# smallest angle of a triangle
MIN_CELL_ANGLE_DEG = 20.0
# a group without symmetries
IDENTITY: Floats = np.eye(2)[None]
# of an edge: images of one point, and places that a symmetric mesh maps onto each other
ORBIT_TOLERANCE = 1e-6


@dataclass(frozen=True)
class MeshConstraints:
    """Points and segments that a mesh contains."""

    vectors: Floats  # (2, 2) mm, lattice vectors as rows
    points: Floats  # (F, 2) mm, in the cell
    size: Floats  # (F,) mm, target length of the edges at the points
    # a, b, step: (E,), (E,), (E, 2) segments from point a to the image `step` of point b, at most one cell long.
    a: Ints
    b: Ints
    step: Ints
    # (G, 2, 2) rotations and reflections about the origin that keep points, segments and lattice; the identity first.
    group: Floats
    # wall_a, wall_b: (W, 2) mm, pieces of the mirror lines. Free points keep a distance from them.
    wall_a: Floats
    wall_b: Floats


def conforming_triangulation(frame: MeshConstraints, edge_mm: float) -> PeriodicTriangles:
    """Triangles of the given points, which come first, and of free ones with edges of about `edge_mm`.

    Raises `MeshError` if no sweep has all segments as edges, the symmetry of the group, and angles of
    `MIN_CELL_ANGLE_DEG`: arms nearly touch, or meet at a small angle.
    """
    beside, vectors, group = _Beside(frame, edge_mm), frame.vectors, frame.group
    seeds = _grid(vectors, edge_mm)
    seeds = seeds[~beside.too_near(seeds)]
    seeds = seeds[_in_one_domain(seeds, group, vectors)]
    best, best_angle, last = None, 0.0, REFINEMENT_SWEEPS.stop
    for sweep in range(40):
        orbits = Orbits.of(seeds, group, vectors, edge_mm)
        triangulation = periodic_delaunay(np.vstack([frame.points, orbits.points]), vectors, edge_mm, group)
        mend = sweep in REFINEMENT_SWEEPS
        angle = float(triangulation.angles.min())
        if not mend and sweep > REFINEMENT_SWEEPS.start and angle > best_angle and _is_conforming(triangulation, frame):
            best, best_angle, last = triangulation, angle, max(sweep, last)
        if (
            best is not None
            and sweep > REFINEMENT_SWEEPS.stop
            and (best_angle > 35.0 or sweep > last + 6)  # good, or without a better one for so many sweeps
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
    if best_angle < MIN_CELL_ANGLE_DEG:
        raise MeshError(f"the mesh of the cell would have angles of {best_angle:.1f} degrees: use a shorter edge")
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
        margin = 0.5 + 3.0 * edge_mm * np.linalg.norm(inverse, axis=0)  # images count up to three edges from the cell

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
        # growth of the edges per distance from shorter ones on the arms
        return np.asarray(np.minimum((self._size + 0.4 * distance).min(axis=1), self._edge_mm))

    def too_near(self, free: Floats) -> Bools:
        """(n,) whether points are close to an arm or a given point, or inside the circle over a segment."""
        size = self.size(free)
        near = np.asarray(self._tree.query(free)[0] < MIN_POINT_DISTANCE_RATIO * size)
        if len(self._a):
            near |= (distance_to_segment(free[:, None], self._a, self._b) < 0.5 * size[:, None]).any(axis=1)
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
    # circumradius over the local edge length, above which a triangle gets a point; 0.58 for an equilateral triangle
    large = np.flatnonzero(ratio > 0.85)
    places = middle[large[np.argsort(-ratio[large], kind="stable")]]
    return home(places, triangulation.vectors)


def _is_conforming(triangulation: PeriodicTriangles, frame: MeshConstraints) -> bool:
    """Whether every given segment is an edge, and the triangles have the symmetry of the group."""
    has_segments = np.isin(triangulation.name(frame.a, frame.b, frame.step), triangulation.edges()[0]).all()
    if not has_segments or len(frame.group) == 1:
        return bool(has_segments)
    middles = triangulation.places.reshape(-1, 3, 2).mean(axis=1)
    return _is_symmetric(middles, frame.group, frame.vectors, float(frame.size.max()))


def home(places: Floats, vectors: Floats) -> Floats:
    """(n, 2) mm, the images of places that lie in the cell."""
    return np.asarray(places - np.floor(places @ np.linalg.inv(vectors) + 1e-9) @ vectors)


def nearest_image(offsets: Floats, vectors: Floats) -> Floats:
    """(..., 2) mm, the shortest of the vectors that differ from an offset (..., 2) by lattice vectors."""
    rounded = offsets - np.rint(offsets @ np.linalg.inv(vectors)) @ vectors
    every = rounded[..., None, :] + CELLS_AROUND @ vectors
    nearest = np.linalg.norm(every, axis=-1).argmin(axis=-1)
    return np.asarray(np.take_along_axis(every, nearest[..., None, None], axis=-2)[..., 0, :])


@dataclass(frozen=True)
class Orbits:
    """Points of a cell, orbit by orbit."""

    seeds: Floats  # (n, 2) mm, one point of each orbit
    points: Floats  # (N, 2) mm, in the cell
    orbit: Ints  # (N,) number of the orbit of each point
    element: Ints  # (N,) element of the group that takes the seed to the point

    @classmethod
    def of(cls, seeds: Floats, group: Floats, vectors: Floats, edge_mm: float) -> Orbits:
        """The orbits of seeds (n, 2); a seed that some elements keep has a smaller orbit."""
        every = home(np.einsum("gij,nj->ngi", group, seeds).reshape(-1, 2), vectors).reshape(len(seeds), len(group), 2)
        apart = np.linalg.norm(nearest_image(every[:, :, None] - every[:, None], vectors), axis=-1)
        is_copy = (np.tril(apart < ORBIT_TOLERANCE * edge_mm, -1)).any(axis=2)
        orbit, element = np.nonzero(~is_copy)
        return cls(seeds, every[orbit, element], orbit, element)

    def moved(self, points: Floats, group: Floats, vectors: Floats) -> Floats:
        """(n, 2) mm, new seeds from new places (N, 2) of all points: the mean over each orbit.

        A seed with a smaller orbit lies at the centre of a rotation and stays.
        """
        back = np.einsum("nji,nj->ni", group[self.element], points)  # inverse is the transpose
        step = nearest_image(back - self.seeds[self.orbit], vectors)
        count = np.bincount(self.orbit, minlength=len(self.seeds))
        mean = np.column_stack([np.bincount(self.orbit, one, len(self.seeds)) for one in step.T]) / count[:, None]
        return np.where((count == len(group))[:, None], self.seeds + mean, self.seeds)

    def gathered(self, distance: Floats, vectors: Floats) -> Floats:
        """(n, 2) mm, seeds; one that is closer than a distance (n,) to its images moves to the middle of them."""
        step = nearest_image(self.points - self.seeds[self.orbit], vectors)
        near = np.linalg.norm(step, axis=1) < distance[self.orbit]
        count = np.bincount(self.orbit[near], minlength=len(self.seeds))
        total = np.column_stack([np.bincount(self.orbit[near], one[near], len(self.seeds)) for one in step.T])
        return np.asarray(self.seeds + total / np.maximum(count, 1)[:, None])


def _in_one_domain(places: Floats, group: Floats, vectors: Floats) -> Bools:
    """(n,) whether places (n, 2) lie in one fundamental domain of the group."""
    # a point in general position, as parts of the lattice vectors; its neighbourhood is one fundamental domain
    images = np.einsum("gij,j->gi", group, np.array([0.2137, 0.0911]) @ vectors)
    apart = np.linalg.norm(nearest_image(places[:, None] - images, vectors), axis=-1)
    return np.asarray(apart.argmin(axis=1) == 0)


def _is_symmetric(places: Floats, group: Floats, vectors: Floats, edge_mm: float) -> bool:
    """Whether the group maps a set of places (n, 2) onto itself, up to lattice vectors."""
    copies = (home(places, vectors) + (CELLS_AROUND @ vectors)[:, None]).reshape(-1, 2)
    tree = cKDTree(copies)
    moved = home(np.einsum("gij,nj->gni", group[1:], places).reshape(-1, 2), vectors)
    return bool(len(moved) == 0 or tree.query(moved)[0].max() < ORBIT_TOLERANCE * edge_mm)
