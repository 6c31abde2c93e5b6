"""The lattice-aligned mesh: nearly equilateral triangles whose edges are a whole part of the stars' distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from pattern.arm_stations import Stations, arm_stations
from pattern.errors import MeshError
from pattern.hexagon_border import HexagonBorder
from pattern.lattice_grid import ON_LINE, GridPatch, LatticeGrid
from pattern.layout import Floats, Ints, Layout
from pattern.mesh import Mesh
from pattern.mesh_check import checked
from pattern.pin_vertices import SAME_PLACE_MM, pin_points, pin_vertices

# flatter triangles than this (degrees) are left to the Delaunay mesh, which refines where it is narrow
SMALLEST_ANGLE = 15.0


def aligned_mesh(layout: Layout, edge_mm: float) -> Mesh:
    """Refine the lattice of the stars and move the grid points near tips and border onto them.

    Parameters
    ----------
    edge_mm : wished length of an edge; the lattice distance is cut into the nearest whole number of edges.

    Raises
    ------
    MeshError : where arms do not lie on lattice lines, or moving grid points would flatten triangles.
    """
    if not (np.isfinite(edge_mm) and edge_mm > 0):
        raise MeshError(f"the mesh edge must be positive, got {edge_mm}")
    grid = LatticeGrid.of(layout, edge_mm)
    hexagon = HexagonBorder.of(layout, grid)
    if hexagon is None:
        raise MeshError("border not supported yet")
    return _hexagon_mesh(layout, grid, hexagon)


def _hexagon_mesh(layout: Layout, grid: LatticeGrid, hexagon: HexagonBorder) -> Mesh:
    """The grid hexagon with its own connectivity, moved onto the border."""
    outline = hexagon.places(layout, grid)
    place_of = {(*ij,): k for k, ij in enumerate(hexagon.ring.tolist())}

    def border(start: Ints, step: Ints) -> tuple[int, Floats]:
        count = hexagon.exit(start, step)
        return count, outline[place_of[(*(start + count * step).tolist(),)]] if count >= 0 else outline[0]

    stations = arm_stations(layout, grid, border)
    patch = hexagon.patch(grid)
    ring = patch.index(hexagon.ring)
    known, places = prescribed(patch, ring, outline, stations)
    points = moved(patch, known, places, pin_points(layout))
    first = int(np.argmin(np.linalg.norm(points[ring] - layout.border[0], axis=1)))
    border_vertices = np.roll(ring, -first)
    mesh = Mesh(
        points=points,
        triangles=patch.triangles(),
        rods=tuple(patch.index(arm) for arm in stations.arms),
        star_vertices=patch.index(grid.centres(layout)),
        border_vertices=border_vertices,
        pin_vertices=pin_vertices(layout, points, border_vertices),
        kind="aligned",
    )
    return checked(mesh, layout, SMALLEST_ANGLE)


def prescribed(patch: GridPatch, ring: Ints, outline: Floats, stations: Stations) -> tuple[NDArray[np.bool_], Floats]:
    """Which points of the patch have their place from the outline, arms and gaps (n,), and all places (n, 2) in mm."""
    at = patch.index(stations.ij)
    known, places = np.zeros(len(patch.ij), dtype=bool), patch.grid.place(patch.ij)
    known[ring], places[ring] = True, outline
    known[at[at >= 0]] = True
    places[at[at >= 0]] = stations.places[at >= 0]
    if np.abs(places[at] - stations.places)[at >= 0].max(initial=0) > ON_LINE * patch.grid.edge_mm * patch.grid.k:
        raise MeshError("arms want the same grid points")
    return known, places


def moved(patch: GridPatch, known: NDArray[np.bool_], places: Floats, pins: Floats) -> Floats:
    """Places (n, 2) of all grid points of a patch: the known ones, one on each pin, and the others smoothly between."""
    natural = patch.grid.place(patch.ij)
    points = natural + patch.harmonic(known, places - natural)
    distance = cKDTree(points[known]).query(pins)[0]
    missing = pins[distance > SAME_PLACE_MM]
    if not len(missing):
        return points
    known, places = known.copy(), places.copy()
    for pin in missing:
        away = np.where(known, np.inf, np.linalg.norm(points - pin, axis=1))
        nearest = int(np.argmin(away))
        if away[nearest] > patch.grid.edge_mm:
            raise MeshError(f"no free grid point near the pin at ({pin[0]:g}, {pin[1]:g}) mm")
        known[nearest], places[nearest] = True, pin
    return natural + patch.harmonic(known, places - natural)
