"""The free mesh of a unit cell: points on the arms or rods, which lie anywhere, and others around them.

A mesh is symmetric about a mirror line only if no pair of mirrored points has a tie with its neighbours. So each line
gets points of its own, and free points keep a distance from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.cell.conforming_triangulation import (
    IDENTITY,
    MeshConstraints,
    conforming_triangulation,
    home,
    nearest_image,
)
from asterism.homogenize.cell.periodic_mesh import TOUCHING_TOLERANCE, MeshPath, PeriodicMesh, tiled
from asterism.homogenize.cell.point_group import NEIGHBOUR_STEPS, POINT_GROUP_TOLERANCE, MirrorLine, mirror_lines
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_segment
from asterism.pattern.mesh.outline_points import least_pieces

if TYPE_CHECKING:
    from asterism.pattern.rods.motif_graph import MotifGraph

# steps along an arm, for the distance to others; half as many along a rod or a piece of a line
_FINE = 256
# distance of the first point beside a star's centre from the nearest arm, over the edge length
MIN_FIRST_GAP_RATIO = 0.6
# length of an edge, over the distance to the arms of other stars
MAX_EDGE_TO_GAP_RATIO = 1.5


def free_cell_mesh(
    lattice_vectors: Floats,
    directions: Floats,
    length: float,
    edge_mm: float,
    repeat: tuple[int, int],
    surrounded: bool,
    group: Floats,
) -> PeriodicMesh:
    """Mesh of `repeat` cells with equal stars: the mesh of one cell, repeated.

    Raises `MeshError` as `conforming_triangulation` does.

    Parameters
    ----------
    lattice_vectors : (2, 2) mm, rows, as of `Lattice.vectors`.
    directions : (N, 2) unit vectors of the arms.
    length : mm, of every arm, at most the spacing. Tips may meet; other parts of different stars keep a distance.
    edge_mm : about, of the mesh; edges are shorter where arms of different stars come close.
    surrounded : the mesh includes the triangles around, whose points are then unfolded too.
    group : (G, 2, 2) rotations and reflections of star and lattice, whose symmetry the mesh has.
    """
    vectors = np.asarray(lattice_vectors, dtype=float)
    edge_mm = min(edge_mm, float(np.linalg.norm(vectors, axis=1).min()) / 3.0)
    frame, arms = _frame(vectors, directions, length, edge_mm)
    frame = _with_symmetry(frame, group, _nearby_arms(frame, directions, length), edge_mm)
    return tiled(conforming_triangulation(frame, edge_mm), repeat, arms, surrounded, of_stars=True)


def _frame(
    vectors: Floats, directions: Floats, length: float, edge_mm: float
) -> tuple[MeshConstraints, list[MeshPath]]:
    """The points on the arms, and the paths of the arms over them."""
    inverse, same = np.linalg.inv(vectors), TOUCHING_TOLERANCE * float(np.linalg.norm(vectors, axis=1).min())
    points, sizes, arms = [np.zeros(2)], [edge_mm], []
    for direction in directions:
        along = _stations(vectors, directions, direction, length, edge_mm)
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


def _stations(vectors: Floats, directions: Floats, direction: Floats, length: float, edge_mm: float) -> Floats:
    """(n + 1,) mm along an arm: equal steps, shorter ones near arms of other stars."""
    even = length / max(1, round(length / edge_mm))
    along = np.linspace(0.0, length, _FINE + 1)
    stars = np.repeat(NEIGHBOUR_STEPS @ vectors, len(directions), axis=0)
    tips = stars + length * np.tile(directions, (len(NEIGHBOUR_STEPS), 1))
    apart = np.linalg.norm(tips - length * direction, axis=1) > TOUCHING_TOLERANCE * np.linalg.norm(vectors)
    gap = distance_to_segment((along[:, None] * direction)[:, None], stars[apart], tips[apart]).min(axis=1)
    if MAX_EDGE_TO_GAP_RATIO * gap.min() < 1e-3 * edge_mm:
        raise MeshError("arms of neighbouring stars overlap")
    return graded_steps(along, even, gap)


@dataclass(frozen=True)
class NearbyArms:
    """All arms near a cell, as segments, with the points on them."""

    # a, b: (n, 2) mm, centre and tip of each arm.
    a: Floats
    b: Floats
    points: Floats  # (m, 2) mm, the mesh points on the arms
    centres: Floats  # (c, 2) mm, those that are centres of stars


def _with_symmetry(frame: MeshConstraints, group: Floats, arms: NearbyArms, edge_mm: float) -> MeshConstraints:
    """Constraints with the points that a mesh of this symmetry needs: on mirror lines, and at fourfold centres."""
    vectors, same = frame.vectors, POINT_GROUP_TOLERANCE * edge_mm
    places, sizes, walls = _mirror_points(mirror_lines(vectors, group), arms, edge_mm, same)
    if (np.abs(group - [[0.0, -1.0], [1.0, 0.0]]).max(axis=(1, 2)) < POINT_GROUP_TOLERANCE).any():
        places, sizes = np.vstack([places, 0.5 * vectors.sum(axis=0)]), np.append(sizes, edge_mm)
    points, size = list(frame.points), list(frame.size)
    for place, wish in zip(home(places, vectors), sizes, strict=True):
        apart = np.linalg.norm(nearest_image(np.array(points) - place, vectors), axis=1)
        if apart.min() > same:
            points.append(place)
            size.append(wish)
        else:
            known = int(apart.argmin())
            size[known] = min(size[known], wish)
    return replace(
        frame, points=np.array(points), size=np.array(size), group=group, wall_a=walls[:, 0], wall_b=walls[:, 1]
    )


def _mirror_points(
    lines: list[MirrorLine], arms: NearbyArms, edge_mm: float, same: float
) -> tuple[Floats, Floats, Floats]:
    """Places (n, 2) mm and edge lengths (n,) mm of points on mirror lines, and the pieces (m, 2, 2) between them.

    Each line is given over one period. Pieces along arms are left out; some places are images of each other.
    """
    places, sizes, walls = [np.empty((0, 2))], [np.empty(0)], [np.empty((0, 2, 2))]
    for line in lines:
        stops = _stops(line, lines, arms, same)
        for a, b in pairwise(stops):
            middle = line.point + 0.5 * (a + b) * line.direction
            if len(arms.a) and distance_to_segment(middle, arms.a, arms.b).min() < same:
                continue
            along, size = _mirror_stations(line, a, b, arms, edge_mm, same)
            on_line = line.point + along[:, None] * line.direction
            places.append(on_line)
            sizes.append(size)
            walls.append(np.stack([on_line[:-1], on_line[1:]], axis=1))
    return np.concatenate(places), np.concatenate(sizes), np.concatenate(walls)


def _stops(line: MirrorLine, others: list[MirrorLine], arms: NearbyArms, same: float) -> Floats:
    """(n,) mm along one period of a line: points of arms, and crossings with other mirror lines."""
    relative = arms.points - line.point
    stops = list(relative[np.abs(relative @ line.normal) < same] @ line.direction)
    for other in others:
        slope = float(line.direction @ other.normal)
        if abs(slope) < 1e-9:
            continue
        start = float((line.point - other.point) @ other.normal)
        count = math.ceil((abs(start) + line.length) / other.offset_step) + 1
        stops += list((other.offset_step * np.arange(-count, count + 1) - start) / slope)
    whole = np.sort([stop for stop in stops if -same < stop < line.length + same])
    kept = whole[np.concatenate([[True], np.diff(whole) > same])] if len(whole) else whole
    first = kept[0] if len(kept) else 0.0  # a line without stops begins anywhere
    inner = kept[kept < first + line.length - same]
    return np.concatenate([inner if len(inner) else [first], [first + line.length]])


def _mirror_stations(
    line: MirrorLine, a: float, b: float, arms: NearbyArms, edge_mm: float, same: float
) -> tuple[Floats, Floats]:
    """Positions (n,) mm from a to b, both included, and edge lengths there (n,) mm."""
    ends = [line.point + stop * line.direction for stop in (a, b)]
    touches = np.zeros(len(arms.a), dtype=bool)
    first = []
    for end, sign in zip(ends, (1.0, -1.0), strict=True):
        if len(arms.a):
            touches |= distance_to_segment(end, arms.a, arms.b) < same
        first.append(_first_step(end, sign * line.direction, arms, edge_mm, same))
    low, high = a + first[0], b - first[1]
    if high - low < same:  # both ends are centres with little room: at most a point in the middle
        middle = 0.5 * (a + b)
        short = 0.5 * (b - a) < MIN_FIRST_GAP_RATIO * min(step for step in first if step)
        along = np.array([a, b] if short else [a, middle, b])
    else:
        fine = np.linspace(low, high, _FINE // 2 + 1)
        gap = np.full(len(fine), np.inf)
        if (~touches).any():
            places = line.point + fine[:, None] * line.direction
            gap = distance_to_segment(places[:, None], arms.a[~touches], arms.b[~touches]).min(axis=1)
        along = graded_steps(fine, edge_mm, gap)
        along = np.concatenate([[a] if first[0] else [], along, [b] if first[1] else []])
    step = np.diff(along)
    size = np.minimum(np.concatenate([step[:1], step]), np.concatenate([step, step[-1:]]))
    return along, np.minimum(size, edge_mm)


def _first_step(end: Floats, ahead: Floats, arms: NearbyArms, edge_mm: float, same: float) -> float:
    """mm from a star's centre to the first point on a line between two arms; 0 if the line ends elsewhere."""
    if not len(arms.a) or np.linalg.norm(arms.centres - end, axis=1).min() > same:
        return 0.0
    own = np.linalg.norm(arms.a - end, axis=1) < same
    out = (arms.b - arms.a)[own]
    cosine = float((out @ ahead / np.linalg.norm(out, axis=1)).max())
    sine = math.sqrt(max(1.0 - cosine**2, 0.0)) if cosine > 0.0 else 1.0
    return max(edge_mm, MIN_FIRST_GAP_RATIO * edge_mm / max(sine, 1e-3))


def graded_steps(fine: Floats, longest: float, gap: Floats) -> Floats:
    """(n + 1,) mm, points from the first to the last of fine points (m,).

    Parameters
    ----------
    fine : (m,) mm, increasing positions at which the gap is known.
    longest : mm, of an edge.
    gap : (m,) mm, distance to other arms.

    >>> graded_steps(np.linspace(0.0, 6.0, 61), 2.0, np.full(61, np.inf)).round(9).tolist()
    [0.0, 2.0, 4.0, 6.0]
    """
    wish = np.minimum(longest, MAX_EDGE_TO_GAP_RATIO * gap)
    wish = (wish + 0.6 * np.abs(fine[:, None] - fine)).min(axis=1)  # growth per distance
    count = np.concatenate([[0.0], np.cumsum(0.5 * (1.0 / wish[1:] + 1.0 / wish[:-1]) * np.diff(fine))])
    # a line may lack a quarter of an edge to one edge more; equal lines get equal numbers
    number = max(1, math.ceil(round(count[-1] - 0.25, 6)))
    return np.interp(np.linspace(0.0, count[-1], number + 1), count, fine)


def motif_cell_mesh(
    motif: MotifGraph, edge_mm: float, repeat: tuple[int, int] = (1, 1), surrounded: bool = False
) -> PeriodicMesh:
    """Mesh of `repeat` cells: the mesh of one cell, repeated. Its first vertex is the first node of the motif.

    The mesh lies in the same way to the motif wherever the motif lies to the lattice. Raises `MeshError` as
    `conforming_triangulation` does.

    Parameters
    ----------
    edge_mm : about, of the mesh; edges are shorter where rods come close, and where they curve.
    surrounded : the mesh includes the triangles around, whose points are then unfolded too.
    """
    vectors = motif.vectors
    edge_mm = min(edge_mm, float(np.linalg.norm(vectors, axis=1).min()) / 3.0)
    constraints, paths = _constraints(motif, edge_mm)
    return tiled(conforming_triangulation(constraints, edge_mm), repeat, paths, surrounded, of_stars=False)


def _constraints(motif: MotifGraph, edge_mm: float) -> tuple[MeshConstraints, list[MeshPath]]:
    """Points on the rods, nodes first, as places from the first node; and the paths of the rods over them."""
    inverse, origin = np.linalg.inv(motif.vectors), motif.nodes[0]

    def cell_of(places: Floats) -> Ints:
        return np.floor(places @ inverse + 1e-9).astype(np.int64)

    node_cell = cell_of(motif.nodes - origin)
    points = [motif.nodes - origin - node_cell @ motif.vectors]
    sizes = np.full(len(motif.nodes), edge_mm)
    inner_sizes: list[Floats] = []
    paths: list[MeshPath] = []
    count = len(motif.nodes)
    for number, rod in enumerate(motif.rods):
        along = _rod_stations(motif, number, edge_mm)
        step = np.diff(along)
        places = rod.at(rod.points, along[1:-1] / rod.length) - origin
        cells = cell_of(places)
        own = count + np.arange(len(places))
        count += len(places)
        points.append(places - cells @ motif.vectors)
        inner_sizes.append(np.minimum(step[:-1], step[1:]))
        for node, first in ((rod.start, step[0]), (rod.end, step[-1])):
            sizes[node] = min(sizes[node], first)
        ends = node_cell[rod.start], motif.end_image[number] + node_cell[rod.end]
        paths.append(MeshPath(np.array([rod.start, *own, rod.end]), np.vstack([ends[0], cells, ends[1]])))
    a, b = (np.concatenate([path.point[part] for path in paths]) for part in (slice(None, -1), slice(1, None)))
    steps = np.concatenate([np.diff(path.image, axis=0) for path in paths])
    walls, size = np.empty((0, 2)), np.concatenate([sizes, *inner_sizes])
    return MeshConstraints(motif.vectors, np.concatenate(points), size, a, b, steps, IDENTITY, walls, walls), paths


def _rod_stations(motif: MotifGraph, number: int, edge_mm: float) -> Floats:
    """(n + 1,) mm along a rod: even steps, shorter ones where rods come close that do not meet it."""
    rod = motif.rods[number]
    least = 1.0 if rod.length < 0.5 * edge_mm else least_pieces(rod)
    longest = rod.length / max(round(rod.length / edge_mm), least)
    along = np.linspace(0.0, rod.length, _FINE // 2 + 1)
    gap = np.full(len(along), np.inf)
    places = shapely.points(rod.at(rod.points, along / rod.length))
    for other in _images_beside(motif, number):
        gap = np.minimum(gap, shapely.distance(places, shapely.LineString(other)))
    if gap.min() < 1e-6:
        x, y = rod.at(rod.points, along[gap.argmin() : gap.argmin() + 1] / rod.length)[0]
        raise MeshError(
            f"two lines touch at ({x:.3g}, {y:.3g}) mm: move the end of one away, or to an end of the other"
        )
    return graded_steps(along, longest, gap)


def _images_beside(motif: MotifGraph, number: int) -> list[Floats]:
    """Points (n, 2) of the rods around a rod that have no node in common with it."""
    own = _nodes_of(motif, number, np.zeros(2, dtype=np.int64))
    reach = max(float(np.linalg.norm(np.ptp(rod.points, axis=0))) for rod in motif.rods)
    height = 1.0 / np.linalg.norm(np.linalg.inv(motif.vectors), axis=0).max()  # of the cell
    span = np.arange(-1, 2) if reach <= height else np.arange(-(n := int(np.ceil(2.0 * reach / height))), n + 1)
    around = np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2)
    return [
        other.points + shift @ motif.vectors
        for which, other in enumerate(motif.rods)
        for shift in around
        if not own & _nodes_of(motif, which, shift)
    ]


def _nodes_of(motif: MotifGraph, number: int, shift: Ints) -> set[tuple[int, int, int]]:
    """The nodes of an image of a rod, each with its cell."""
    rod, end = motif.rods[number], shift + motif.end_image[number]
    return {(rod.start, int(shift[0]), int(shift[1])), (rod.end, int(end[0]), int(end[1]))}
