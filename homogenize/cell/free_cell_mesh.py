"""The free mesh of a unit cell: points on the arms, which lie anywhere, and others around them, closed to a torus."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from equilibrium.arrays import Floats, Ints
from homogenize.cell.conforming_triangulation import IDENTITY, MeshConstraints, conforming_triangulation
from homogenize.cell.graded_steps import MAX_EDGE_TO_GAP_RATIO, graded_steps
from homogenize.cell.image_numbering import ImageNumbering, new_triangles
from homogenize.cell.mirror_points import NearbyArms, with_symmetry
from homogenize.cell.periodic_delaunay import PeriodicTriangles
from homogenize.cell.periodic_mesh import TOUCHING_TOLERANCE, PeriodicMesh
from pattern.design.errors import MeshError
from pattern.geometry.planar import distance_to_segment

# smallest angle of a triangle
MIN_CELL_ANGLE_DEG = 20.0
# stars whose arms, up to the spacing long, may come close, as numbers of lattice vectors
NEIGHBOUR_STEPS = np.array([[i, j] for i in range(-3, 4) for j in range(-3, 4) if (i, j) != (0, 0)])
# steps along an arm, for the distance to other arms
_FINE = 256


def free_cell_mesh(
    lattice_vectors: Floats,
    directions: Floats,
    length: float,
    edge_mm: float,
    repeat: tuple[int, int] = (1, 1),
    segments: int | None = None,
    surrounded: bool = False,
    group: Floats | None = None,
) -> PeriodicMesh:
    """Mesh of `repeat` cells with equal stars: the mesh of one cell, repeated.

    Parameters
    ----------
    lattice_vectors : (2, 2) mm, rows, as of `Lattice.vectors`.
    directions : (N, 2) unit vectors of the arms.
    length : mm, of every arm, at most the spacing. Tips may meet; other parts of different stars keep a distance.
    edge_mm : about, of the mesh; edges are shorter where arms of different stars come close.
    segments : edges of an arm far from other arms; by default the number nearest to its length.
    surrounded : the mesh includes the triangles around, whose points are then unfolded too.
    group : (G, 2, 2) rotations and reflections of star and lattice, whose symmetry the mesh has; none by default.

    Raises
    ------
    MeshError
        There is no mesh with all angles above `MIN_CELL_ANGLE_DEG`: arms nearly touch, or meet at a small angle.
    """
    vectors = np.asarray(lattice_vectors, dtype=float)
    edge_mm = min(edge_mm, float(np.linalg.norm(vectors, axis=1).min()) / 3.0)
    frame, arms = _frame(vectors, directions, length, edge_mm, segments)
    if group is not None:
        frame = with_symmetry(frame, group, _nearby_arms(frame, directions, length), edge_mm)
    triangulation = conforming_triangulation(frame, edge_mm)
    least = float(triangulation.angles.min())
    if least < MIN_CELL_ANGLE_DEG:
        raise MeshError(f"the mesh of the cell would have angles of {least:.1f} degrees: use a shorter edge")
    return _Tiles(triangulation, repeat).torus(arms, surrounded)


@dataclass(frozen=True)
class _Arm:
    """The path of an arm from the star's centre, which is point 0.

    Attributes
    ----------
    point : (n,) points; image : (n, 2) their images.
    """

    point: Ints
    image: Ints


def _frame(
    vectors: Floats, directions: Floats, length: float, edge_mm: float, segments: int | None
) -> tuple[MeshConstraints, list[_Arm]]:
    """The points on the arms, and the paths of the arms over them."""
    inverse, same = np.linalg.inv(vectors), TOUCHING_TOLERANCE * float(np.linalg.norm(vectors, axis=1).min())
    points, sizes, arms = [np.zeros(2)], [edge_mm], []
    for direction in directions:
        along = _stations(vectors, directions, direction, length, edge_mm, segments)
        step = np.diff(along)
        sizes[0] = min(sizes[0], step[0])
        arm = _Arm(np.zeros(len(along), dtype=np.int64), np.zeros((len(along), 2), dtype=np.int64))
        for k, place in enumerate(along[1:, None] * direction, start=1):
            off = place - np.array(points)
            image = np.round(off @ inverse).astype(np.int64)
            met = np.flatnonzero(np.linalg.norm(off - image @ vectors, axis=1) < same)
            if len(met):  # another star's tip
                arm.point[k], arm.image[k] = met[0], image[met[0]]
                continue
            arm.point[k], arm.image[k] = len(points), np.floor(place @ inverse + 1e-9)
            points.append(place - arm.image[k] @ vectors)
            sizes.append(step[k - 1 : k + 1].min())
        arms.append(arm)
    none = np.empty(0, dtype=np.int64)
    a = np.concatenate([none, *(arm.point[:-1] for arm in arms)])
    b = np.concatenate([none, *(arm.point[1:] for arm in arms)])
    steps = np.concatenate([none.reshape(0, 2), *(np.diff(arm.image, axis=0) for arm in arms)])
    walls = np.empty((0, 2))
    return MeshConstraints(vectors, np.array(points), np.array(sizes), a, b, steps, IDENTITY, walls, walls), arms


def _nearby_arms(frame: MeshConstraints, directions: Floats, length: float) -> NearbyArms:
    """The arms of the star and of its neighbours."""
    centres = np.vstack([np.zeros((1, 2)), NEIGHBOUR_STEPS @ frame.vectors])
    a = np.repeat(centres, len(directions), axis=0)
    points = (frame.points + centres[:, None]).reshape(-1, 2)
    return NearbyArms(a, a + length * np.tile(directions, (len(centres), 1)), points, centres)


def _stations(
    vectors: Floats, directions: Floats, direction: Floats, length: float, edge_mm: float, segments: int | None
) -> Floats:
    """(n + 1,) mm along an arm: equal steps, shorter ones near arms of other stars."""
    even = length / max(1, segments or round(length / edge_mm))
    along = np.linspace(0.0, length, _FINE + 1)
    stars = np.repeat(NEIGHBOUR_STEPS @ vectors, len(directions), axis=0)
    tips = stars + length * np.tile(directions, (len(NEIGHBOUR_STEPS), 1))
    apart = np.linalg.norm(tips - length * direction, axis=1) > TOUCHING_TOLERANCE * np.linalg.norm(vectors)
    gap = distance_to_segment((along[:, None] * direction)[:, None], stars[apart], tips[apart]).min(axis=1)
    if MAX_EDGE_TO_GAP_RATIO * gap.min() < 1e-3 * edge_mm:
        raise MeshError("arms of neighbouring stars overlap")
    return graded_steps(along, even, gap)


class _Tiles:
    """The triangles of one cell, repeated in n x m cells that close to a larger torus."""

    def __init__(self, triangles: PeriodicTriangles, repeat: tuple[int, int]) -> None:
        self._triangles = triangles
        self._cells = np.array([[i, j] for i in range(repeat[0]) for j in range(repeat[1])])
        self._repeat = np.array(repeat)
        self._number = ImageNumbering(len(self._cells) * len(triangles.points))

    def _all(self, point: Ints, image: Ints) -> Ints:
        """(n m E, k) unfolded points of points (E, k) with images (E, k, 2), in every cell."""
        where = self._cells[:, None, None] + image
        away, home = where // self._repeat, where % self._repeat
        base = (home[..., 0] * self._repeat[1] + home[..., 1]) * len(self._triangles.points) + point
        return self._number(base.ravel(), *away.reshape(-1, 2).T).reshape(-1, point.shape[1])

    def torus(self, arms: list[_Arm], surrounded: bool) -> PeriodicMesh:
        """The whole mesh, with these arms on every star."""
        mesh = self._triangles
        triangles = self._all(mesh.corner, mesh.image)
        point, image = _pairs(mesh)
        # a hinge from either side is the same: that whose edge has the lower name
        there, back = mesh.edges()
        once = there < back
        from_base = image - image[:, :1]
        hinges = self._all(point[once], from_base[once])
        rods = [self._all(arm.point[None], arm.image[None]) for arm in arms]
        around: Ints = np.empty((0, 3), dtype=np.int64)
        if surrounded:
            around = new_triangles(self._all(*_touching(mesh)), triangles)
        stars = self._all(np.zeros((1, 1), dtype=np.int64), np.zeros((1, 1, 2), dtype=np.int64))[:, 0]
        base, away = self._number.unfolded()
        cell = mesh.vectors * self._repeat[:, None]
        tiled = (mesh.points + (self._cells @ mesh.vectors)[:, None]).reshape(-1, 2)
        return PeriodicMesh(
            points=tiled[base] + away @ cell,
            base=base,
            image=away,
            triangles=triangles,
            around=around,
            hinges=hinges,
            rods=tuple(rod for star in zip(*rods, strict=True) for rod in star),
            arm_star=np.repeat(np.arange(len(stars)), len(arms)),
            star_vertices=stars,
            cell_vectors=cell,
            n_base=len(tiled),
        )


def _touching(mesh: PeriodicTriangles) -> tuple[Ints, Ints]:
    """Points (M, 3) and images (M, 3, 2) of all triangles that share a point with a triangle of the cell."""
    at = mesh.corner.ravel()
    order = np.argsort(at, kind="stable")
    first = np.searchsorted(at[order], np.arange(len(mesh.points) + 1))
    count = np.diff(first)[at]
    own = np.repeat(np.arange(len(at)), count)  # a corner of the cell, once for each triangle at its point
    within = np.arange(len(own)) - np.repeat(np.cumsum(count) - count, count)
    other = order[first[at[own]] + within]
    step = mesh.image.reshape(-1, 2)[own] - mesh.image.reshape(-1, 2)[other]
    return mesh.corner[other // 3], mesh.image[other // 3] + step[:, None]


def _pairs(mesh: PeriodicTriangles) -> tuple[Ints, Ints]:
    """Points (3 T, 4) and images (3 T, 4, 2) of the edges of all triangles: two ends, left apex, right apex."""
    there, back = mesh.edges()
    order = np.argsort(there)
    twin = order[np.searchsorted(there[order], back)]
    turns = np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]])
    corner, image = mesh.corner[:, turns].reshape(-1, 3), mesh.image[:, turns].reshape(-1, 3, 2)
    # the twin's edge runs back: its second point is this one's first
    right = image[:, 0] + image[twin, 2] - image[twin, 1]
    return np.column_stack([corner, corner[twin, 2]]), np.concatenate([image, right[:, None]], axis=1)
