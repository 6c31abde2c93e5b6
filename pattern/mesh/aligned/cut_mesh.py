"""The lattice grid cut along any outline: equilateral inside, fitted to evenly spaced outline points in a strip."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_outline, inside, mean_circumcentres, triangle_angles
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.aligned.arm_stations import BorderStations, arm_stations
from asterism.pattern.mesh.aligned.grid_motion import moved, prescribed
from asterism.pattern.mesh.aligned.lattice_grid import ON_LINE_TOLERANCE, GridPatch, LatticeGrid
from asterism.pattern.mesh.free.triangulate import triangulate
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.outline_points import outline_points, pin_vertices, pins_on_sheet

# free grid points keep this distance from the outline, in grid edges
GRID_MARGIN_EDGES = 0.7
# arms and pins keep this distance from the outline unless they are on it, in grid edges
ARM_MARGIN_EDGES = 0.1
# arms whose tips are closer to the outline, in grid edges, get edges of half the length
HALVED_GAP_EDGES = 0.3
# points closer to the outline, in grid edges, are smoothed
SMOOTHED_STRIP_EDGES = 2.6
MAX_SMOOTHINGS = 4
# points are added at triangles with a smaller angle: beside tips that end close to the outline
REFINED_ANGLE_DEG = 28.0


def cut_mesh(layout: Layout, grid: LatticeGrid, enough: float = np.inf) -> Mesh:
    """The grid with its points moved onto arms and pins, cut off at the border and triangulated with it.

    The strip along the border is smoothed until all angles are `enough` (degrees).
    """
    tolerance = ON_LINE_TOLERANCE * grid.edge_mm * grid.k
    pins = pins_on_sheet(layout)
    patch = _patch_around(layout, grid)
    stations = arm_stations(layout, grid, _ends_on_border(layout, grid, tolerance))
    taken, known, places = prescribed(patch, stations)
    points = moved(patch, taken, known, places, pins[distance_to_outline(pins, layout.outline) > tolerance])

    arms = patch.paths(stations.arms)
    points, arms = _halved(points, arms, layout, grid.edge_mm)
    fixed = np.zeros(len(points), dtype=bool)
    fixed[np.concatenate([patch.index(stations.centres), *arms])] = True
    away, at_pin = cKDTree(points).query(pins)
    fixed[at_pin[away <= tolerance]] = True
    distance = distance_to_outline(points, layout.outline)
    on_border = fixed & (distance <= tolerance)
    clear = inside(points, layout.outline) & (distance >= ARM_MARGIN_EDGES * grid.edge_mm)
    if (fixed & ~on_border & ~clear).any():
        raise MeshError("an arm or a pin is closer to the outline than a mesh edge allows")
    wanted = np.concatenate([layout.arm_tip, layout.centres, pins])
    outline = outline_points(layout.outline, grid.edge_mm, wanted, tolerance, points[fixed & ~on_border])
    keep = (inside(points, layout.outline) & (distance > GRID_MARGIN_EDGES * grid.edge_mm)) | fixed & ~on_border
    vertex = np.full(len(points), -1)
    vertex[keep] = np.arange(keep.sum()) + len(outline)
    vertex[on_border] = cKDTree(outline).query(points[on_border])[1]
    rods = tuple(vertex[arm] for arm in arms)
    border = np.arange(len(outline))
    segments = np.concatenate(
        [np.column_stack([border, np.roll(border, -1)]), *(np.column_stack([r[:-1], r[1:]]) for r in rods)]
    )
    still = np.concatenate(
        [np.ones(len(outline), dtype=bool), fixed[keep] | (distance[keep] > SMOOTHED_STRIP_EDGES * grid.edge_mm)]
    )
    points, triangles = _smoothed(np.concatenate([outline, points[keep]]), segments, still, enough)
    return Mesh(
        points=points,
        triangles=triangles,
        rods=rods,
        star_vertices=vertex[patch.index(stations.centres)],
        border_vertices=border,
        pin_vertices=pin_vertices(layout, points, border),
        kind="aligned",
    )


def _patch_around(layout: Layout, grid: LatticeGrid) -> GridPatch:
    """Grid points on the sheet, and enough around it for every arm and for moves across the outline."""
    ij = grid.window(layout.outline.min(axis=0), layout.outline.max(axis=0))
    places = grid.place(ij)
    near = inside(places, layout.outline)
    near[~near] = distance_to_outline(places[~near], layout.outline) < 2 * grid.edge_mm
    return GridPatch(grid, ij[near])


def _ends_on_border(layout: Layout, grid: LatticeGrid, tolerance: float) -> BorderStations:
    """For arms that end on the outline: their number of edges and their tip."""
    steps = grid.directions(layout)
    on = distance_to_outline(layout.arm_tip, layout.outline) <= tolerance
    count = np.maximum(np.rint(layout.arm_length / np.linalg.norm(steps @ grid.basis, axis=1) * grid.k), 1)
    count = np.where(on, count.astype(np.int64), np.iinfo(np.int64).max)
    return lambda start, step: (count, layout.arm_tip)


def _halved(points: Floats, arms: list[Ints], layout: Layout, edge_mm: float) -> tuple[Floats, list[Ints]]:
    """Halve the edges of arms that end just inside the outline, where triangles must be small; points are added."""
    gap = distance_to_outline(layout.arm_tip, layout.outline)
    arms = list(arms)
    for arm in np.flatnonzero((gap > ON_LINE_TOLERANCE * edge_mm) & (gap < HALVED_GAP_EDGES * edge_mm)):
        start, end = arms[arm][:-1], arms[arm][1:]
        arms[arm] = np.append(np.column_stack([start, len(points) + np.arange(len(start))]).ravel(), end[-1])
        points = np.concatenate([points, (points[start] + points[end]) / 2])
    return points, arms


def _smoothed(points: Floats, segments: Ints, still: NDArray[np.bool_], enough: float) -> tuple[Floats, Ints]:
    """Triangulate, and move the points that are not still to where their triangles are best, a few times."""
    points, triangles = triangulate(points, segments, min_angle_deg=REFINED_ANGLE_DEG)
    still = np.pad(still, (0, len(points) - len(still)))
    best, best_angle = (points, triangles), triangle_angles(points, triangles).min()
    for _ in range(MAX_SMOOTHINGS):
        if best_angle >= enough:
            break
        points = np.where(still[:, None], points, mean_circumcentres(points, triangles))
        points, triangles = triangulate(points, segments)
        angle = triangle_angles(points, triangles).min()
        if angle > best_angle:
            best, best_angle = (points, triangles), angle
    return best
