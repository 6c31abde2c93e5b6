"""The free mesh of a unit cell: points on the arms, which lie anywhere, and others around them, closed to a torus."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.conforming_triangulation import IDENTITY, MeshConstraints, conforming_triangulation
from asterism.homogenize.cell.graded_steps import MAX_EDGE_TO_GAP_RATIO, graded_steps
from asterism.homogenize.cell.mirror_points import NearbyArms, with_symmetry
from asterism.homogenize.cell.periodic_mesh import TOUCHING_TOLERANCE, PeriodicMesh
from asterism.homogenize.cell.tiles import MeshPath, Tiles
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_segment

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
    return Tiles(triangulation, repeat).star_mesh(arms, surrounded)


def _frame(
    vectors: Floats, directions: Floats, length: float, edge_mm: float, segments: int | None
) -> tuple[MeshConstraints, list[MeshPath]]:
    """The points on the arms, and the paths of the arms over them."""
    inverse, same = np.linalg.inv(vectors), TOUCHING_TOLERANCE * float(np.linalg.norm(vectors, axis=1).min())
    points, sizes, arms = [np.zeros(2)], [edge_mm], []
    for direction in directions:
        along = _stations(vectors, directions, direction, length, edge_mm, segments)
        step = np.diff(along)
        sizes[0] = min(sizes[0], step[0])
        arm = MeshPath(np.zeros(len(along), dtype=np.int64), np.zeros((len(along), 2), dtype=np.int64))
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
