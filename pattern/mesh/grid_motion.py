"""Grid points that carry the arms and the gaps behind their tips: they move to their places, the others with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.lattice_grid import ON_LINE_TOLERANCE, GridPatch, LatticeGrid
from asterism.pattern.mesh.outline_points import PIN_VERTEX_TOLERANCE_MM

# shortest edge along arms and gaps, over the edge of the grid
MIN_STATION_EDGE_FACTOR = 0.25
BorderStations = Callable[[Ints, Ints], tuple[Ints, Floats]]
# shift of grid points by which diagonals of squares are chosen, in grid edges: far above rounding, and invisible
OFF_SQUARE_SHIFT = 1e-6
NO_POINTS = np.zeros(0, dtype=np.int64)
NO_PLACES = np.zeros((0, 2))


@dataclass(frozen=True)
class Stations:
    """Grid points of the arms, and all grid points that are moved to a place.

    Attributes
    ----------
    centres : (S, 2) grid points of the stars.
    arms : one (n + 1, 2) array of grid points an arm, from the star's centre to the tip.
    ij, places : (P, 2) grid points, and their places in mm; a point may occur more than once.
    """

    centres: Ints
    arms: tuple[Ints, ...]
    ij: Ints
    places: Floats


@dataclass
class _ArmLinks:
    """The grid points ahead of the star of each arm (A, ...): `count` edges to the place `end` (mm), `taken` by it."""

    start: Ints
    step: Ints
    count: Ints
    end: Floats
    taken: Ints


def arm_stations(layout: Layout, grid: LatticeGrid, border: BorderStations) -> Stations:
    """Spread every arm evenly over grid edges, and the gap behind its tip over those left on its link.

    Parameters
    ----------
    border : for the grid points (A, 2) and directions (A, 2) of the arms, the number (A,) of grid edges to the border
        and the places (A, 2) mm of the grid points there; a number beyond the arm where the border takes none.
    """
    links, centres = _links(layout, grid, border), grid.centres(layout)
    centre, tip, length = layout.centres[layout.arm_star], layout.arm_tip, layout.arm_length
    other = _others(links)
    facing = other >= 0
    tolerance = ON_LINE_TOLERANCE * grid.edge_mm * grid.k
    overlap = facing & (length + length[other] > np.linalg.norm(links.end - centre, axis=1) + tolerance)
    if overlap.any():
        one = int(np.argmax(overlap))
        raise MeshError(f"arms {one} and {other[one]} overlap")
    meeting = np.linalg.norm(tip[other] - tip, axis=1) <= tolerance
    for one in np.flatnonzero(facing & (np.arange(len(other)) < other)).tolist():
        pair = [one, int(other[one])]
        links.taken[pair] = _shared(int(links.count[one]), links.taken[pair], length[pair], bool(meeting[one]))
    left = links.count - np.where(facing, links.taken[other], 0) - links.taken
    end = np.where(facing[:, None], tip[other], links.end)
    edge = length / links.taken
    edge = np.where(left > 0, np.minimum(edge, np.linalg.norm(end - tip, axis=1) / np.maximum(left, 1)), edge)
    if (edge < MIN_STATION_EDGE_FACTOR * grid.edge_mm).any():
        one = int(np.argmax(edge < MIN_STATION_EDGE_FACTOR * grid.edge_mm))
        raise MeshError(f"arm {one} leaves too little room for a mesh edge at its tip")
    arm, number = _numbered(links.taken)
    on_arms = links.start[arm] + number[:, None] * links.step[arm]
    gap = np.flatnonzero(left > 0)
    which, ahead = _numbered(left[gap])
    first = links.start + links.taken[:, None] * links.step
    in_gaps = first[gap][which] + ahead[:, None] * links.step[gap][which]
    ij = [in_gaps, centres, on_arms]
    places = [_even(tip[gap], end[gap], left[gap]), layout.centres, _even(centre, tip, links.taken)]
    arms = tuple(np.split(on_arms, np.cumsum(links.taken + 1)[:-1])) if len(length) else ()
    return Stations(centres, arms, np.concatenate(ij), np.concatenate(places))


def _links(layout: Layout, grid: LatticeGrid, border: BorderStations) -> _ArmLinks:
    """The link of every arm: up to the lattice point at or behind its tip, or to the border."""
    centres, step, length = grid.centres(layout), grid.directions(layout), layout.arm_length
    start, centre = centres[layout.arm_star], layout.centres[layout.arm_star]
    spacing = np.linalg.norm(step @ grid.basis, axis=1)
    steps = np.maximum(np.ceil(length / spacing - ON_LINE_TOLERANCE), 1).astype(np.int64)
    stars = {(*ij,) for ij in centres.tolist()}
    for arm in np.flatnonzero(steps > 1).tolist():
        if any((*(start[arm] + n * grid.k * step[arm]).tolist(),) in stars for n in range(1, steps[arm])):
            raise MeshError(f"arm {arm} runs through another star")
    count = steps * grid.k
    end = grid.place(start + count[:, None] * step)
    to_border, there = border(start, step)
    cut = to_border < count
    count[cut], end[cut] = to_border[cut], there[cut]
    reach = np.linalg.norm(end - centre, axis=1)
    off = (length <= 0) | (count < 1) | (length > reach + ON_LINE_TOLERANCE * spacing)
    if off.any():
        raise MeshError(f"arm {np.argmax(off)} has no length, or leaves the sheet")
    part = np.clip(np.rint(length / reach * count), 1, count - 1).astype(np.int64)
    taken = np.where(np.linalg.norm(end - layout.arm_tip, axis=1) > ON_LINE_TOLERANCE * spacing, part, count)
    if not taken.all():
        raise MeshError(f"arm {np.argmin(taken)} needs a shorter mesh edge")
    return _ArmLinks(start, step, count, end, taken)


def _others(links: _ArmLinks) -> Ints:
    """(A,) the arm that comes from the other end of each link, -1 for none."""
    ends = {(*row,): arm for arm, row in enumerate(np.hstack([links.start, links.step]).tolist())}
    ahead = np.hstack([links.start + links.count[:, None] * links.step, -links.step])
    return np.array([ends.get((*row,), -1) for row in ahead.tolist()], dtype=np.int64)


def _shared(count: int, taken: Ints, length: Floats, meeting: bool) -> Ints:
    """(2,) the grid edges of a link, divided between the arms from both its ends: all if they meet, else leave one."""
    room = count if meeting else count - 1
    if room < 2:
        raise MeshError("arms from both ends of a link need a shorter mesh edge")
    one, other = (int(number) for number in taken)
    if meeting:
        one = min(max(round(float(length[0] / length.sum()) * room), 1), room - 1)
        other = room - one
    while one + other > room:
        # the arm whose edges are the shorter ones gives one up
        edges = [part / number if number > 1 else np.inf for part, number in zip(length, (one, other), strict=True)]
        one, other = (one - 1, other) if edges[0] <= edges[1] else (one, other - 1)
    return np.array([one, other])


def _numbered(count: Ints) -> tuple[Ints, Ints]:
    """Row and number 0 ... n of the points of rows that have `count` (A,) n edges each."""
    row = np.repeat(np.arange(len(count)), count + 1)
    return row, np.arange(len(row)) - (np.cumsum(count + 1) - count - 1)[row]


def _even(first: Floats, last: Floats, count: Ints) -> Floats:
    """(P, 2) places from each first one (A, 2) to the last, n equal edges apart; the ends exactly."""
    row, number = _numbered(count)
    places = number[:, None] * ((last - first) / count[:, None])[row] + first[row]
    places[np.cumsum(count + 1) - 1] = last
    return places


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
        raise MeshError("two arms need the same grid point")
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
