"""The triangular grid that refines the lattice of the stars: points move onto arms and gaps, the others with them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import cross_2d
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.outline_points import PIN_VERTEX_TOLERANCE_MM

# points this close to a grid line are on it, in spacings
ON_LINE_TOLERANCE = 1e-6
# small weight that keeps points in place if no path connects them to a known point
HOLDING_WEIGHT = 1e-9
# shortest edge along arms and gaps, over the edge of the grid
MIN_STATION_EDGE_FACTOR = 0.25
# shift of grid points by which diagonals of squares are chosen, in grid edges: far above rounding, and invisible
OFF_SQUARE_SHIFT = 1e-6
NO_POINTS = np.zeros(0, dtype=np.int64)
NO_PLACES = np.zeros((0, 2))


@dataclass(frozen=True)
class LatticeGrid:
    """Points `origin + ij @ basis / k` for whole numbers ij, each lattice triangle cut into k^2."""

    origin: Floats  # (2,) mm
    basis: Floats  # (2, 2) mm, rows: lattice vectors at most 90 degrees apart, the second to the left of the first
    k: int  # grid edges between neighbouring lattice points

    @classmethod
    def of(cls, layout: Layout, edge_mm: float) -> LatticeGrid:
        """The grid of a layout whose edges are closest to `edge_mm`.

        Right-angled cells have an even number of them: the mirror lines between stars are grid lines. The mesh has
        their symmetry, unless tips that nearly touch need points that the triangulation adds.
        """
        a, b = np.asarray(layout.lattice_vectors, dtype=float)
        each = 2 if is_right_angled(a, b) else 1
        k = max(each * round(float(np.sqrt((a @ a + b @ b) / 2)) / edge_mm / each), 2)
        return cls(np.asarray(layout.lattice_origin, dtype=float), np.array([a, b]), k)

    @cached_property
    def right_angled(self) -> bool:
        """The cells are squares or rectangles, whose two diagonals are equally long."""
        return is_right_angled(*self.basis)

    @cached_property
    def edge_mm(self) -> float:
        """Length of a grid edge (mean of the two axes)."""
        return float(np.linalg.norm(self.basis, axis=1).mean() / self.k)

    def lattice_coordinates(self, vectors: Floats) -> Floats:
        """Vectors (n, 2) in mm as multiples of the lattice vectors."""
        return vectors @ np.linalg.inv(self.basis)

    def place(self, ij: Ints) -> Floats:
        """Where grid points (n, 2) are, mm."""
        return self.origin + ij @ self.basis / self.k

    def centres(self, layout: Layout) -> Ints:
        """Grid points (S, 2) of the stars."""
        where = self.lattice_coordinates(layout.centres - self.origin)
        off = np.abs(where - np.rint(where)).max(axis=1, initial=0)
        if (off > ON_LINE_TOLERANCE).any():
            raise MeshError(
                f"star {layout.star_number[np.argmax(off > ON_LINE_TOLERANCE)]} is not at a point of the lattice"
            )
        return np.asarray(np.rint(where).astype(np.int64) * self.k)

    def directions(self, layout: Layout) -> Ints:
        """Grid direction (A, 2) along which each arm points."""
        step = GRID_DIRECTIONS @ self.basis
        unit = step / np.linalg.norm(step, axis=1, keepdims=True)
        arm = layout.arm_tip - layout.centres[layout.arm_star]
        best = np.argmax(arm @ unit.T, axis=1)
        off = np.abs(cross_2d(arm, unit[best])) > ON_LINE_TOLERANCE * np.linalg.norm(self.basis[0])
        if off.any():
            star = layout.star_number[layout.arm_star[np.argmax(off)]]
            raise MeshError(f"an arm of star {star} does not lie on a line of the lattice")
        return np.asarray(GRID_DIRECTIONS[best])

    def window(self, low: Floats, high: Floats) -> Ints:
        """Grid points (n, 2) in the box from `low` to `high` (2,) in mm and a little around it, sorted."""
        corners = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
        span = self.lattice_coordinates(corners - self.origin) * self.k
        (i0, j0), (i1, j1) = np.floor(span.min(axis=0)).astype(int), np.ceil(span.max(axis=0)).astype(int)
        ij = np.stack(np.meshgrid(np.arange(i0, i1 + 1), np.arange(j0, j1 + 1), indexing="ij"), axis=-1).reshape(-1, 2)
        where = self.place(ij)
        return ij[((where >= low - self.edge_mm) & (where <= high + self.edge_mm)).all(axis=1)]


def is_right_angled(a: Floats, b: Floats) -> bool:
    """Whether two lattice vectors (2,) are perpendicular."""
    return bool(abs(a @ b) < ON_LINE_TOLERANCE * (a @ a))


class GridPatch:
    """Some points of a grid, the triangles and edges between them, and the way back from grid coordinates."""

    def __init__(self, grid: LatticeGrid, ij: Ints) -> None:
        self.grid, self.ij = grid, ij
        self.low = ij.min(axis=0) - 1
        self.table = np.full(np.ptp(ij, axis=0) + 3, -1, dtype=np.int64)
        self.table[tuple((ij - self.low).T)] = np.arange(len(ij))

    def index(self, ij: Ints) -> Ints:
        """Number of each grid point (..., 2) in the patch, -1 for those outside."""
        shifted = ij - self.low
        known = ((shifted >= 0) & (shifted < self.table.shape)).all(axis=-1)
        shifted = np.where(known[..., None], shifted, 0)
        return np.asarray(np.where(known, self.table[shifted[..., 0], shifted[..., 1]], -1))

    @cached_property
    def _ahead(self) -> Ints:
        """(3, n) the neighbours of all points in the first three directions, -1 for those outside.

        In right-angled cells (4, n), with both diagonals.
        """
        at = (self.ij - self.low).T
        steps = GRID_DIRECTIONS[:3].tolist() + ([[1, 1]] if self.grid.right_angled else [])
        return np.array([self.table[at[0] + i, at[1] + j] for i, j in steps])

    def paths(self, lines: Sequence[Ints]) -> list[Ints]:
        """Numbers of the grid points of each line (n, 2), all at once."""
        if not lines:
            return []
        return np.split(self.index(np.concatenate(lines)), np.cumsum([len(line) for line in lines])[:-1])

    def triangles(self) -> Ints:
        """Triangles (T, 3), counterclockwise, all of whose corners are in the patch."""
        own, ahead = np.arange(len(self.ij)), self._ahead
        triangles = np.concatenate([np.column_stack([own, ahead[q], ahead[q + 1]]) for q in (0, 1)])
        return np.asarray(triangles[triangles.min(axis=1) >= 0])

    def harmonic(self, known: NDArray[np.bool_], values: Floats) -> Floats:
        """Values (n, 2), given at `known` points, continued to the others so that each is its neighbours' mean."""
        ends, free = self._ahead.ravel(), np.flatnonzero(~known)
        result = np.where(known[:, None], values, 0.0)
        if not len(free):
            return result
        own = np.tile(np.arange(len(known)), len(self._ahead))[ends >= 0]
        ahead = csr_array((np.ones(len(own)), (own, ends[ends >= 0])), shape=2 * (len(known),))
        joins = (ahead + ahead.T)[free]
        between = diags_array(joins.sum(axis=1) + HOLDING_WEIGHT) - joins[:, free]
        factor = splu(between.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        result[free] = factor.solve(joins @ result)
        return result


BorderStations = Callable[[Ints, Ints], tuple[Ints, Floats]]


@dataclass(frozen=True)
class Stations:
    """Grid points of the arms, and all grid points that are moved to a place."""

    centres: Ints  # (S, 2) grid points of the stars
    arms: tuple[Ints, ...]  # one (n + 1, 2) array of grid points an arm, from the star's centre to the tip
    # ij, places: (P, 2) grid points, and their places in mm; a point may occur more than once.
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
    """Which points of a patch are on arms or the outline (n,), which have a place (gaps too), and all places (n, 2)."""
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
