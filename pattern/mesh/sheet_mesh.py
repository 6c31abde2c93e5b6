"""A coarse mesh of a sheet for a shell of high order.

The outline has as few points as a coarse mesh needs, and the same area. Corners and the ends of supported edges keep
their places. Between them, a line of many short edges becomes a line of few longer ones. It moves outwards or inwards
until the area of the sheet is restored.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import (
    dense_outline,
    distance_to_outline,
    distance_to_segment,
    inside,
    mean_circumcentres,
    polygon_area,
    triangle_angles,
    turning_angles,
)
from asterism.pattern.geometry.plane_lattice import PlaneLattice
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.mesh.outline_points import outline_points, place_within
from asterism.pattern.mesh.triangulate import triangulate


@dataclass(frozen=True)
class SheetMesh:
    """Triangles of the sheet."""

    points: Floats  # (P, 2) mm; supported points are among them
    triangles: Ints  # (T, 3), counterclockwise
    rim: Ints  # (R, 2) points at the ends of the mesh edges of the outline and of the holes; the sheet lies to the left
    side: Ints  # (R,) the edge of the sheet each of them is on, see `SheetEdges`

    @property
    def rings(self) -> tuple[Floats, ...]:
        """(n, 2) mm each, points around the outline and around each hole."""
        ends = np.flatnonzero(self.rim[:, 1] < self.rim[:, 0]) + 1
        return tuple(np.split(self.points[self.rim[:, 0]], ends[:-1]))


def sheet_mesh(
    border: Floats,
    edge_mm: float,
    held_points: Floats | None = None,
    held_sides: Sequence[Sequence[int]] = (),
    holes: Sequence[Floats] = (),
) -> SheetMesh:
    """Mesh a polygon with holes.

    Raises `MeshError` if the outline crosses itself.

    Parameters
    ----------
    border : (B, 2) mm, simple polygon, counterclockwise.
    edge_mm : length of the mesh's edges, about; near holes that are smaller, edges are shorter.
    held_points : (n, 2) mm, supported points on the sheet; they become points of the mesh.
    held_sides : groups of edges of the sheet that are supported alike, numbered as in `SheetEdges`. Where a group ends,
        there is a point of the mesh.
    holes : (n, 2) mm each, inside the polygon and apart from each other.
    """
    held = np.empty((0, 2)) if held_points is None else np.asarray(held_points, dtype=float).reshape(-1, 2)
    near = 1e-6 * float(np.ptp(border, axis=0).max())
    edges = SheetEdges.of(border, holes)
    on = np.array([distance_to_outline(held, ring) <= near for ring in edges.rings])
    beside = held[~on.any(axis=0)]
    rings, sides = [], []
    for k, ring in enumerate(edges.rings):
        others = [dense_outline(other, 0.25 * edge_mm) for n, other in enumerate(edges.rings) if n != k]
        first = int(edges.numbers(k)[0])
        groups = [[edge - first for edge in group if 0 <= edge - first < len(ring)] for group in held_sides]
        points, side = _ring(ring, edge_mm, held[on[k]], np.concatenate([beside, *others]), groups, near)
        rings.append(points)
        sides.append(first + side)
    starts = np.cumsum([0, *map(len, rings)])
    numbers = [np.arange(a, b) for a, b in pairwise(starts)]
    rim = np.concatenate([np.column_stack([each, np.roll(each, -1)]) for each in numbers])
    fixed = np.concatenate([*rings, beside])
    places = [place_within(ring) for ring in rings[1:]]
    points, triangles = _relaxed(fixed, _filling(rings, fixed, edge_mm), rim, edge_mm, places)
    return SheetMesh(points, triangles, rim, np.concatenate(sides))


def _ring(
    ring: Floats, edge_mm: float, held: Floats, beside: Floats, groups: Sequence[Sequence[int]], near: float
) -> tuple[Floats, Ints]:
    """Points along a ring, and the side of the ring that each mesh edge from there to the next lies on."""
    group = np.full(len(ring), -1)
    for one, its in enumerate(groups):
        group[list(its)] = one
    ends = group != np.roll(group, 1)
    points, side, fixed = [], [], []
    for k, (a, b) in enumerate(zip(ring, np.roll(ring, -1, axis=0), strict=True)):
        on = held[distance_to_segment(held, a, b) <= near]
        pinned = (np.linalg.norm(on - a, axis=1) <= near).any()
        between = on[(np.linalg.norm(on - a, axis=1) > near) & (np.linalg.norm(on - b, axis=1) > near)]
        between = between[np.argsort((between - a) @ (b - a))]
        points.append(np.concatenate([a[None], between]))
        side.append(np.full(len(between) + 1, k))
        fixed.append(np.r_[pinned or ends[k], np.ones(len(between), dtype=bool)])
    number = np.concatenate(side)
    coarse, coarse_side = coarse_outline(np.concatenate(points), edge_mm, np.flatnonzero(np.concatenate(fixed)))
    fine = outline_points(coarse, edge_mm, np.empty((0, 2)), near, beside)
    corner = cKDTree(fine).query(coarse)[1]
    return fine, np.repeat(number[coarse_side], np.diff([*corner, len(fine)]))


def _filling(rings: Sequence[Floats], fixed: Floats, edge_mm: float) -> Floats:
    """Inner points: those of the triangular lattice along the longest straight piece of the outline."""
    ring, *holes = rings
    step = np.roll(ring, -1, axis=0) - ring
    longest = int(np.linalg.norm(step, axis=1).round(9).argmax())
    size = float(np.linalg.norm(step[longest]))
    x, y = step[longest] / size
    half, height = 0.5, np.sqrt(0.75)
    basis = size * np.array([[x, y], [half * x - height * y, half * y + height * x]])
    lattice = PlaneLattice(basis, ring[longest])
    points = lattice.place(lattice.cells_within(ring.min(axis=0), ring.max(axis=0)))
    points = points[inside(points, ring, holes)]
    if not len(points):
        return np.empty((0, 2))
    away = np.min([cKDTree(fixed).query(points)[0], *(distance_to_outline(points, each) for each in rings)], axis=0)
    # inner points keep their distance from the outline and from supported points
    return np.asarray(points[away > 0.6 * edge_mm])


def _relaxed(fixed: Floats, free: Floats, rim: Ints, edge_mm: float, holes: Sequence[Floats]) -> tuple[Floats, Ints]:
    """Points and triangles, the free points moved so that triangles are nearly equilateral."""
    points, triangles = triangulate(np.concatenate([fixed, free]), rim, holes=holes)
    for _ in range(4 if len(free) else 0):
        moved = mean_circumcentres(points, triangles)[len(fixed) :]
        if np.abs(moved - points[len(fixed) :]).max() < 0.02 * edge_mm:
            break
        try:
            points, triangles = triangulate(np.concatenate([fixed, moved]), rim, holes=holes)
        except MeshError:  # a point left the sheet
            break
    # beside a hole smaller than the triangles
    if holes and triangle_angles(points, triangles).min() < 15.0:
        points, triangles = triangulate(points, rim, min_angle_deg=25.0, holes=holes)
    return points, triangles


def coarse_outline(border: Floats, edge_mm: float, fixed: Ints) -> tuple[Floats, Ints]:
    """A simpler ring (n, 2) mm, and for each of its sides (n,) the first of the outline's sides that it stands for.

    Parameters
    ----------
    border : (B, 2) mm, simple polygon.
    edge_mm : what counts as short.
    fixed : corners that must stay.
    """
    # an outline that turns by more has a corner there
    kept = np.union1d(fixed, np.flatnonzero(np.abs(turning_angles(border)) > np.radians(35.0))).astype(np.int64)
    whole = np.arange(len(border))
    if len(kept) == len(border):
        return border, whole
    # without corners the ring begins anywhere, and that point moves with the others
    starts = kept if len(kept) else np.array([0])
    points, sides, loose = [], [], []
    for start, end in zip(starts, np.roll(starts, -1), strict=True):
        count = (end - start) % len(border) or len(border)
        numbers = (start + np.arange(count + 1)) % len(border)
        # before the simplified line is moved, it is at most this far from the outline
        chosen = _simplified(border[numbers], 0.06 * edge_mm)
        points.append(border[numbers[chosen[:-1]]])
        sides.append(numbers[chosen[:-1]])
        moves = np.full(len(chosen) - 1, len(chosen) <= count)
        moves[0] = len(kept) == 0
        loose.append(moves)
    ring, moving = np.concatenate(points), np.concatenate(loose)
    ring = _same_area(ring, moving, polygon_area(border))
    if len(ring) < 3 or not shapely.is_valid(shapely.polygons(ring)):
        return border, whole
    return ring, np.concatenate(sides)


def _simplified(line: Floats, tolerance: float) -> Ints:
    """Numbers of the points of a line that stay: the ends, and evenly spread ones as near to it as asked for."""
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    closed = np.allclose(line[0], line[-1])
    for pieces in range(6 if closed else 1, len(line) - 1):
        even = np.searchsorted(length, np.linspace(0.0, length[-1], pieces + 1)[1:-1] - 1e-9 * length[-1])
        chosen = np.unique(np.r_[0, even, len(line) - 1])
        gap = shapely.hausdorff_distance(shapely.linestrings(line[chosen]), shapely.linestrings(line))
        # a line with one piece has no point that could give the area back
        if gap <= tolerance and (len(chosen) > 2 or gap <= 1e-9 * length[-1]):
            return chosen
    return np.arange(len(line))


def _same_area(ring: Floats, moving: np.ndarray, area: float) -> Floats:
    """The ring with its moving points shifted along their normals, all by the same length."""
    if not moving.any():
        return ring
    tangent = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / np.linalg.norm(tangent, axis=1, keepdims=True)
    normal[~moving] = 0.0
    for _ in range(4):  # the area is a quadratic function of the shift: Newton's method
        rate = 0.5 * (normal * np.column_stack([tangent[:, 1], -tangent[:, 0]])).sum()
        ring = ring + (area - polygon_area(ring)) / rate * normal
        tangent = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    return ring
