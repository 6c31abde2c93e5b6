"""A coarse mesh of a sheet for a shell of high order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from scipy.spatial import cKDTree

from asterism.previewing.coarse_outline import coarse_outline
from pattern.errors import MeshError
from pattern.layout import Floats, Ints
from pattern.outline import outline_points
from pattern.planar import distance_to_outline, distance_to_segment, inside, mean_circumcentres
from pattern.triangulate import triangulate

# inner points keep this distance from the outline and from held points, over the edge length
CLEAR = 0.6
SWEEPS = 4


@dataclass(frozen=True)
class SheetMesh:
    """Triangles of the sheet.

    Attributes
    ----------
    points : (P, 2) mm; held points are among them.
    triangles : (T, 3), counterclockwise.
    rim : (R, 2) points at the ends of the outline's mesh edges.
    side : (R,) the border's side each of them is on; -1 on the rim of a hole.
    """

    points: Floats
    triangles: Ints
    rim: Ints
    side: Ints


def sheet_mesh(
    border: Floats,
    edge_mm: float,
    held_points: Floats | None = None,
    held_sides: Sequence[Sequence[int]] = (),
    holes: Sequence[Floats] = (),
) -> SheetMesh:
    """Mesh a polygon.

    Parameters
    ----------
    border : (B, 2) mm, simple polygon, counterclockwise.
    edge_mm : length of the mesh's edges, about.
    held_points : (n, 2) mm, on the sheet; they become points of the mesh.
    held_sides : groups of sides of the border that are held alike; where a group ends there is a point of the mesh.
    holes : polygons inside.

    Raises
    ------
    MeshError
        The outline crosses itself, or a hole is not inside.
    """
    held = np.empty((0, 2)) if held_points is None else np.asarray(held_points, dtype=float).reshape(-1, 2)
    near = 1e-6 * float(np.ptp(border, axis=0).max())
    outlines = [np.asarray(ring, dtype=float) for ring in (border, *holes)]
    on = np.array([distance_to_outline(held, ring) <= near for ring in outlines])
    inner = held[~on.any(axis=0)]
    rings, sides = [], []
    for number, (ring, its) in enumerate(zip(outlines, on, strict=True)):
        points, side = _ring(ring, edge_mm, held[its], inner, held_sides if number == 0 else (), near)
        rings.append(points)
        sides.append(side if number == 0 else np.full(len(points), -1))
    starts = np.cumsum([0, *(len(ring) for ring in rings[:-1])])
    rim = np.concatenate([start + _loop(len(ring)) for start, ring in zip(starts, rings, strict=True)])
    fixed = np.concatenate([*rings, inner])
    in_holes = [shapely.get_coordinates(shapely.point_on_surface(shapely.polygons(ring)))[0] for ring in rings[1:]]
    points, triangles = _relaxed(fixed, _filling(rings, fixed, edge_mm), rim, np.reshape(in_holes, (-1, 2)), edge_mm)
    return SheetMesh(points, triangles, rim, np.concatenate(sides))


def _ring(
    ring: Floats, edge_mm: float, held: Floats, beside: Floats, groups: Sequence[Sequence[int]], near: float
) -> tuple[Floats, Ints]:
    """Points along an outline, and the outline's side that each mesh edge from there to the next lies on."""
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
    coarse = coarse_outline(np.concatenate(points), edge_mm, np.flatnonzero(np.concatenate(fixed)))
    far = np.abs(ring).max() * np.full((1, 2), 1e3)
    fine = outline_points(coarse.points, edge_mm, np.empty((0, 2)), near, beside if len(beside) else far)
    corner = cKDTree(fine).query(coarse.points)[1]
    return fine, np.repeat(number[coarse.side], np.diff([*corner, len(fine)]))


def _loop(count: int) -> Ints:
    """(count, 2) each point and the next one around."""
    return np.column_stack([np.arange(count), np.roll(np.arange(count), -1)])


def _filling(rings: list[Floats], fixed: Floats, edge_mm: float) -> Floats:
    """Inner points: those of the triangular lattice along the longest straight piece of the outline."""
    ring = rings[0]
    step = np.roll(ring, -1, axis=0) - ring
    longest = int(np.linalg.norm(step, axis=1).round(9).argmax())
    size = float(np.linalg.norm(step[longest]))
    x, y = step[longest] / size
    half, height = 0.5, np.sqrt(0.75)
    basis = size * np.array([[x, y], [half * x - height * y, half * y + height * x]])
    box = np.array([[x, y] for x in (ring[:, 0].min(), ring[:, 0].max()) for y in (ring[:, 1].min(), ring[:, 1].max())])
    cells = (box - ring[longest]) @ np.linalg.inv(basis)
    first, last = np.floor(cells.min(axis=0)).astype(int), np.ceil(cells.max(axis=0)).astype(int)
    grid = np.stack(np.meshgrid(*(np.arange(a, b + 1) for a, b in zip(first, last, strict=True)), indexing="ij"), -1)
    points = ring[longest] + grid.reshape(-1, 2) @ basis
    points = points[inside(points, ring)]
    for hole in rings[1:]:
        points = points[~inside(points, hole)]
    return points[_clear(points, rings, fixed, edge_mm)]


def _clear(points: Floats, rings: list[Floats], fixed: Floats, edge_mm: float) -> np.ndarray:
    """Which points keep their distance from outlines and fixed points."""
    if not len(points):
        return np.zeros(0, dtype=bool)
    away = np.min([distance_to_outline(points, ring) for ring in rings], axis=0)
    return np.minimum(away, cKDTree(fixed).query(points)[0]) > CLEAR * edge_mm


def _relaxed(fixed: Floats, free: Floats, rim: Ints, in_holes: Floats, edge_mm: float) -> tuple[Floats, Ints]:
    """Points and triangles, the free points moved so that triangles are nearly equilateral."""
    points, triangles = triangulate(np.concatenate([fixed, free]), rim, holes=in_holes)
    for _ in range(SWEEPS if len(free) else 0):
        moved = mean_circumcentres(points, triangles)[len(fixed) :]
        if np.abs(moved - points[len(fixed) :]).max() < 0.02 * edge_mm:
            break
        try:
            points, triangles = triangulate(np.concatenate([fixed, moved]), rim, holes=in_holes)
        except MeshError:  # a point was pushed over the outline
            break
    return points, triangles
