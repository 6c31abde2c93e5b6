"""A coarse mesh of a sheet for a shell of high order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from equilibrium.arrays import Floats, Ints
from pattern.design.errors import MeshError
from pattern.geometry.planar import distance_to_outline, distance_to_segment, inside, mean_circumcentres
from pattern.mesh.coarse.coarse_outline import coarse_outline
from pattern.mesh.free.triangulate import triangulate
from pattern.mesh.outline_points import outline_points

# inner points keep this distance from the outline and from supported points, in mesh edges
CLEARANCE_EDGES = 0.6
MAX_RELAXATION_SWEEPS = 4


@dataclass(frozen=True)
class SheetMesh:
    """Triangles of the sheet.

    Attributes
    ----------
    points : (P, 2) mm; supported points are among them.
    triangles : (T, 3), counterclockwise.
    rim : (R, 2) points at the ends of the outline's mesh edges.
    side : (R,) the border's side each of them is on.
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
) -> SheetMesh:
    """Mesh a polygon.

    Parameters
    ----------
    border : (B, 2) mm, simple polygon, counterclockwise.
    edge_mm : length of the mesh's edges, about.
    held_points : (n, 2) mm, supported points on the sheet; they become points of the mesh.
    held_sides : groups of edges of the outline that are supported alike. Where a group ends, there is a point of the
        mesh.

    Raises
    ------
    MeshError
        The outline crosses itself.
    """
    held = np.empty((0, 2)) if held_points is None else np.asarray(held_points, dtype=float).reshape(-1, 2)
    near = 1e-6 * float(np.ptp(border, axis=0).max())
    outline = np.asarray(border, dtype=float)
    on = distance_to_outline(held, outline) <= near
    ring, side = _ring(outline, edge_mm, held[on], held[~on], held_sides, near)
    number = np.arange(len(ring))
    rim = np.column_stack([number, np.roll(number, -1)])
    fixed = np.concatenate([ring, held[~on]])
    points, triangles = _relaxed(fixed, _filling(ring, fixed, edge_mm), rim, edge_mm)
    return SheetMesh(points, triangles, rim, side)


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


def _filling(ring: Floats, fixed: Floats, edge_mm: float) -> Floats:
    """Inner points: those of the triangular lattice along the longest straight piece of the outline."""
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
    if not len(points):
        return np.empty((0, 2))
    away = np.minimum(distance_to_outline(points, ring), cKDTree(fixed).query(points)[0])
    return np.asarray(points[away > CLEARANCE_EDGES * edge_mm])


def _relaxed(fixed: Floats, free: Floats, rim: Ints, edge_mm: float) -> tuple[Floats, Ints]:
    """Points and triangles, the free points moved so that triangles are nearly equilateral."""
    points, triangles = triangulate(np.concatenate([fixed, free]), rim)
    for _ in range(MAX_RELAXATION_SWEEPS if len(free) else 0):
        moved = mean_circumcentres(points, triangles)[len(fixed) :]
        if np.abs(moved - points[len(fixed) :]).max() < 0.02 * edge_mm:
            break
        try:
            points, triangles = triangulate(np.concatenate([fixed, moved]), rim)
        except MeshError:  # a point left the outline
            break
    return points, triangles
