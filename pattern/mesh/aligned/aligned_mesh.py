"""The lattice-aligned mesh: nearly equilateral triangles, a whole number of edges to a spacing."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.aligned.arm_stations import arm_stations
from asterism.pattern.mesh.aligned.cut_mesh import cut_mesh
from asterism.pattern.mesh.aligned.grid_motion import moved, prescribed
from asterism.pattern.mesh.aligned.hexagon_border import HexagonBorder
from asterism.pattern.mesh.aligned.lattice_grid import LatticeGrid
from asterism.pattern.mesh.check import check_edge, checked
from asterism.pattern.mesh.grading import Grading
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.pin_vertices import pin_vertices, pins_on_sheet

# meshes with a smaller angle are left to the Delaunay mesh, which refines narrow places
MIN_ALIGNED_ANGLE_DEG = 15.0
# if the grid itself has a smaller angle, a triangulation with additional points replaces it
MIN_GRID_ANGLE_DEG = 22.0
# triangles of a graded mesh are flatter: across an arm they are much finer than along it
MIN_GRADED_ANGLE_DEG = 8.0


def aligned_mesh(layout: Layout, edge_mm: float, graded: bool = False, draft: bool = False) -> Mesh:
    """Refine the lattice of the stars and move the grid points near tips and outline onto them.

    Parameters
    ----------
    edge_mm : requested edge length; the spacing is divided into the nearest whole number of edges.
    graded : as many triangles, but finer ones at arms and tips, see `pattern.mesh.grading`; for hexagons along the
        lattice.
    draft : the strip along other outlines is smoothed only until its angles pass the check.

    Raises
    ------
    MeshError
        Arms do not lie on lattice lines, or moving grid points would flatten triangles.
    """
    check_edge(layout, edge_mm)
    grid = LatticeGrid.of(layout, edge_mm)
    hexagon = HexagonBorder.of(layout, grid)
    if graded:
        if hexagon is None:
            raise MeshError("a graded aligned mesh needs a hexagonal outline along the lattice")
        return checked(_hexagon_mesh(layout, grid, hexagon, Grading.of(layout)), layout, MIN_GRADED_ANGLE_DEG)
    if hexagon is not None:
        try:
            return checked(_hexagon_mesh(layout, grid, hexagon), layout, MIN_GRID_ANGLE_DEG)
        except MeshError:
            # tips close to the outline and pins between grid points need additional points
            pass
    strip = cut_mesh(layout, grid, MIN_ALIGNED_ANGLE_DEG) if draft else cut_mesh(layout, grid)
    return checked(strip, layout, MIN_ALIGNED_ANGLE_DEG)


def _hexagon_mesh(layout: Layout, grid: LatticeGrid, hexagon: HexagonBorder, grading: Grading | None = None) -> Mesh:
    """The grid hexagon with its own connectivity, moved onto the border."""
    outline = hexagon.places(layout, grid)

    def border(start: Ints, step: Ints) -> tuple[Ints, Floats]:
        count = hexagon.exit(start, step)
        return count, outline[hexagon.on_ring(start + count[:, None] * step)]

    stations = arm_stations(layout, grid, border, grading)
    patch = hexagon.patch(grid)
    ring = patch.index(hexagon.ring)
    taken, known, places = prescribed(patch, stations, ring, outline)
    points = moved(patch, taken, known, places, pins_on_sheet(layout), grading)
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
