"""The lattice-aligned mesh: nearly equilateral triangles, a whole number of edges to a spacing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_outline, inside, mean_circumcentres, triangle_angles
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.lattice_grid import (
    ON_LINE_TOLERANCE,
    BorderStations,
    GridPatch,
    LatticeGrid,
    arm_stations,
    moved,
    prescribed,
)
from asterism.pattern.mesh.mesh import Mesh, check_edge, checked
from asterism.pattern.mesh.outline_points import outline_points, pin_vertices, pins_on_sheet
from asterism.pattern.mesh.triangulate import triangulate

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
# meshes with a smaller angle are left to the Delaunay mesh, which refines narrow places
MIN_ALIGNED_ANGLE_DEG = 15.0
# if the grid itself has a smaller angle, a triangulation with additional points replaces it
MIN_GRID_ANGLE_DEG = 22.0


def aligned_mesh(layout: Layout, edge_mm: float, draft: bool = False) -> Mesh:
    """Refine the lattice of the stars and move the grid points near tips and outline onto them.

    Parameters
    ----------
    edge_mm : requested edge length; the spacing is divided into the nearest whole number of edges.
    draft : the strip along other outlines is smoothed only until its angles pass the check.

    Raises
    ------
    MeshError
        Arms do not lie on lattice lines, or moving grid points would flatten triangles.
    """
    check_edge(layout, edge_mm)
    grid = LatticeGrid.of(layout, edge_mm)
    hexagon = HexagonBorder.of(layout, grid)
    if hexagon is not None:
        try:
            return checked(_hexagon_mesh(layout, grid, hexagon), layout, MIN_GRID_ANGLE_DEG)
        except MeshError:
            # tips close to the outline and pins between grid points need additional points
            pass
    strip = cut_mesh(layout, grid, MIN_ALIGNED_ANGLE_DEG) if draft else cut_mesh(layout, grid)
    return checked(strip, layout, MIN_ALIGNED_ANGLE_DEG)


def _hexagon_mesh(layout: Layout, grid: LatticeGrid, hexagon: HexagonBorder) -> Mesh:
    """The grid hexagon with its own connectivity, moved onto the border."""
    outline = hexagon.places(layout, grid)

    def border(start: Ints, step: Ints) -> tuple[Ints, Floats]:
        count = hexagon.exit(start, step)
        return count, outline[hexagon.on_ring(start + count[:, None] * step)]

    stations = arm_stations(layout, grid, border)
    patch = hexagon.patch(grid)
    ring = patch.index(hexagon.ring)
    taken, known, places = prescribed(patch, stations, ring, outline)
    points = moved(patch, taken, known, places, pins_on_sheet(layout))
    first = int(np.argmin(np.linalg.norm(points[ring] - layout.outline[0], axis=1)))
    border_vertices = np.roll(ring, -first)
    return Mesh(
        points=points,
        triangles=patch.triangles(),
        rods=tuple(patch.paths(stations.arms)),
        star_vertices=patch.index(stations.centres),
        border_vertices=border_vertices,
        pin_vertices=pin_vertices(layout, points, border_vertices),
        kind="aligned",
    )


@dataclass(frozen=True)
class HexagonBorder:
    """A hexagon about a lattice point with its corners in the six lattice directions."""

    centre: Ints  # (2,) grid point
    rows: int  # grid edges from the centre to a corner, and along a side
    corners: Floats  # (6, 2) mm, in the order of GRID_DIRECTIONS
    ring: Ints  # (6 rows, 2) grid points on the outline, counterclockwise from the first corner

    @classmethod
    def of(cls, layout: Layout, grid: LatticeGrid) -> HexagonBorder | None:
        """The outline of a layout as such a hexagon; None for other outlines."""
        if len(layout.outline) != 6 or grid.right_angled:  # a hexagon of squares would have one of their diagonals
            return None
        middle = layout.outline.mean(axis=0)
        about = grid.lattice_coordinates(middle[None] - grid.origin)[0]
        corners = grid.lattice_coordinates(layout.outline - middle)
        first = int(np.argmax(corners @ [2, 1]))
        corners, places = np.roll(corners, -first, axis=0), np.roll(layout.outline, -first, axis=0)
        radius = float(corners[0, 0])
        if (
            np.abs(about - np.rint(about)).max() > ON_LINE_TOLERANCE
            or np.abs(corners - radius * GRID_DIRECTIONS).max() > ON_LINE_TOLERANCE
        ):
            return None
        rows = max(round(radius * grid.k), 1)
        centre = np.rint(about).astype(np.int64) * grid.k
        side = np.arange(rows)[:, None]
        ring = [centre + rows * GRID_DIRECTIONS[q] + side * GRID_DIRECTIONS[(q + 2) % 6] for q in range(6)]
        return cls(centre, rows, places, np.concatenate(ring))

    def patch(self, grid: LatticeGrid) -> GridPatch:
        """All grid points in the hexagon."""
        span = np.arange(-self.rows, self.rows + 1)
        ij = np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2)
        return GridPatch(grid, self.centre + ij[np.abs(ij.sum(axis=1)) <= self.rows])

    def exit(self, start: Ints, step: Ints) -> Ints:
        """(n,) number of grid edges from grid points (n, 2) to the outline, in directions (n, 2)."""
        at = start - self.centre
        faces = np.array([[one[:, 0], one[:, 1], one.sum(axis=1)] for one in (at, step)])
        left = self.rows - faces[0] * faces[1]
        return np.asarray(np.where(faces[1] != 0, left, left.max(initial=0)).min(axis=0))

    def on_ring(self, ij: Ints) -> Ints:
        """(n,) number within the ring of grid points (n, 2) that are on it, and any number of others."""
        width = 4 * self.rows + 1
        codes, wanted = ((one - self.centre) @ [width, 1] for one in (self.ring, ij))
        order = np.argsort(codes)
        return np.asarray(order[np.minimum(np.searchsorted(codes[order], wanted), len(order) - 1)])

    def places(self, layout: Layout, grid: LatticeGrid) -> Floats:
        """Places (6 rows, 2) of the ring: evenly spaced between corners, tips and pins on the outline."""
        taken: dict[int, float] = {q * self.rows: float(q * self.rows) for q in range(6)}
        tolerance = ON_LINE_TOLERANCE * grid.edge_mm * grid.k
        tips = np.flatnonzero(distance_to_outline(layout.arm_tip, layout.outline) <= tolerance)
        starts, steps = grid.centres(layout)[layout.arm_star[tips]], grid.directions(layout)[tips]
        stations = starts + self.exit(starts, steps)[:, None] * steps
        for arm, station in zip(tips, self.on_ring(stations).tolist(), strict=True):
            self._take(taken, station, self._along(layout.arm_tip[arm]))
        points = layout.pin_points
        for point in points[distance_to_outline(points, layout.outline) <= tolerance]:
            at = self._along(point)
            if not any(abs(at - t) < 1e-5 for t in taken.values()):
                self._take(taken, round(at) % len(self.ring), at)
        ordered = sorted(taken)
        stations, along = np.array([*ordered, len(self.ring)]), np.array([*(taken[k] for k in ordered), len(self.ring)])
        if (np.diff(along) <= 0).any():
            raise MeshError("tips and pins on the outline are closer together than the mesh edges")
        t = np.interp(np.arange(len(self.ring)), stations, along)
        side = np.minimum(t // self.rows, 5).astype(int)
        part = (t / self.rows - side)[:, None]
        return np.asarray((1 - part) * self.corners[side] + part * self.corners[(side + 1) % 6])

    def _along(self, point: Floats) -> float:
        """How far along the outline a point on it is, in grid edges from the first corner."""
        a, b = self.corners, np.roll(self.corners, -1, axis=0)
        part = np.clip(((point - a) * (b - a)).sum(axis=1) / ((b - a) ** 2).sum(axis=1), 0, 1)
        side = int(np.argmin(np.linalg.norm(a + part[:, None] * (b - a) - point, axis=1)))
        return float(side + part[side]) * self.rows % len(self.ring)

    @staticmethod
    def _take(taken: dict[int, float], station: int, along: float) -> None:
        """Note that a point of the ring has its place; two places for one are refused."""
        if abs(taken.get(station, along) - along) > 1e-5:
            raise MeshError("two tips, pins or corners on the outline need the same mesh vertex")
        taken.setdefault(station, along)


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
