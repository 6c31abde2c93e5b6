"""Moving the points of a lattice grid: some to given places, the others smoothly with them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.mesh.aligned.arm_stations import Stations
from asterism.pattern.mesh.aligned.lattice_grid import ON_LINE_TOLERANCE, GridPatch
from asterism.pattern.mesh.outline_points import PIN_VERTEX_TOLERANCE_MM

# shift of grid points by which diagonals of squares are chosen, in grid edges: far above rounding, and invisible
OFF_SQUARE_SHIFT = 1e-6
NO_POINTS = np.zeros(0, dtype=np.int64)
NO_PLACES = np.zeros((0, 2))


def prescribed(
    patch: GridPatch, stations: Stations, ring: Ints = NO_POINTS, outline: Floats = NO_PLACES
) -> tuple[NDArray[np.bool_], NDArray[np.bool_], Floats]:
    """Which points of a patch are on arms or the outline (n,), which have a place (gaps too), and all places (n, 2).

    Parameters
    ----------
    ring, outline : points of the patch (m,) on the outline, and their places (m, 2) in mm.
    """
    at = patch.index(stations.ij)
    known, places = np.zeros(len(patch.ij), dtype=bool), patch.grid.place(patch.ij)
    known[ring], places[ring] = True, outline
    known[at[at >= 0]] = True
    places[at[at >= 0]] = stations.places[at >= 0]
    if (
        np.abs(places[at] - stations.places)[at >= 0].max(initial=0)
        > ON_LINE_TOLERANCE * patch.grid.edge_mm * patch.grid.k
    ):
        raise MeshError("arms want the same grid points")
    taken = np.zeros_like(known)
    taken[ring] = True
    printed = patch.index(np.concatenate([stations.centres, *stations.arms]))
    if printed.min(initial=0) < 0:
        raise MeshError("a star or an arm leaves the sheet")
    taken[printed] = True
    return taken, known, places


def moved(
    patch: GridPatch,
    taken: NDArray[np.bool_],
    known: NDArray[np.bool_],
    places: Floats,
    pins: Floats,
) -> Floats:
    """Places (n, 2) of all grid points of a patch: the known ones, one on each pin, and the others smoothly between.

    Pins (P, 2) get the nearest points that are not taken.
    """
    points = _spread(patch, known, places)
    missing = pins[cKDTree(points[taken]).query(pins)[0] > PIN_VERTEX_TOLERANCE_MM] if len(pins) else pins
    if not len(missing):
        return points
    taken, known, places = taken.copy(), known.copy(), places.copy()
    for pin in missing:
        away = np.where(taken, np.inf, np.linalg.norm(points - pin, axis=1))
        nearest = int(np.argmin(away))
        if away[nearest] > patch.grid.edge_mm:
            raise MeshError(f"no free grid point near the pin at ({pin[0]:g}, {pin[1]:g}) mm")
        taken[nearest], known[nearest], places[nearest] = True, True, pin
    return _spread(patch, known, places)


def _spread(patch: GridPatch, known: NDArray[np.bool_], places: Floats) -> Floats:
    """All points, evenly between the known ones."""
    natural = patch.grid.place(patch.ij)
    points = natural + patch.harmonic(known, places - natural)
    return points + _off_squares(patch, known) if patch.grid.right_angled else points


def _off_squares(patch: GridPatch, known: NDArray[np.bool_]) -> Floats:
    """(n, 2) mm by which free points leave exact squares, whose two diagonals are equally good, symmetrically.

    With offsets (u, v) from a lattice point, in lattice vectors, the points move along the gradient of
    `sin^2(pi u) sin^2(pi v)`. Its mixed derivative has one sign between two mirror lines, so that the diagonals there
    are parallel, and mirrored beyond.
    """
    u, v = (np.pi * patch.ij / patch.grid.k).T
    along = np.column_stack([np.sin(2.0 * u) * np.sin(v) ** 2, np.sin(u) ** 2 * np.sin(2.0 * v)])
    return np.where(known[:, None], 0.0, OFF_SQUARE_SHIFT / patch.grid.k * along @ patch.grid.basis)
