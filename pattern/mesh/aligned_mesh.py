"""The lattice-aligned mesh: nearly equilateral triangles, a whole number of edges to a spacing.

A triangular grid refines the lattice of the stars. Its points move onto arms and the gaps behind them, the others with
them. Along an outline that is no hexagon of the grid, the grid is cut off and triangulated with the outline.
"""

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
from asterism.pattern.geometry.planar import cross_2d, distance_to_outline, inside, mean_circumcentres, triangle_angles
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh, check_edge, checked
from asterism.pattern.mesh.outline_points import PIN_VERTEX_TOLERANCE_MM, outline_points, pin_vertices
from asterism.pattern.mesh.triangulate import triangulate

# meshes with a smaller angle are left to the Delaunay mesh, which refines narrow places
MIN_ALIGNED_ANGLE_DEG = 15.0
# points this close to a grid line are on it, in spacings
ON_LINE_TOLERANCE = 1e-6
# shortest edge along arms and gaps, over the edge of the grid
MIN_STATION_EDGE_FACTOR = 0.25


def aligned_mesh(layout: Layout, edge_mm: float, draft: bool = False) -> Mesh:
    """Refine the lattice of the stars and move the grid points near tips and outline onto them.

    Raises `MeshError` if arms do not lie on lattice lines, or moving grid points would flatten triangles.

    Parameters
    ----------
    edge_mm : requested edge length; the spacing is divided into the nearest whole number of edges.
    draft : the strip along other outlines is smoothed only until its angles pass the check.
    """
    check_edge(layout, edge_mm)
    grid = _LatticeGrid.of(layout, edge_mm)
    hexagon = _HexagonBorder.of(layout, grid)
    if hexagon is not None:
        try:
            # a triangulation with additional points replaces a grid with smaller angles
            return checked(_hexagon_mesh(layout, grid, hexagon), layout, 22.0)
        except MeshError:
            # tips close to the outline and pins between grid points need additional points
            pass
    strip = _cut_mesh(layout, grid, MIN_ALIGNED_ANGLE_DEG) if draft else _cut_mesh(layout, grid)
    return checked(strip, layout, MIN_ALIGNED_ANGLE_DEG)


def _hexagon_mesh(layout: Layout, grid: _LatticeGrid, hexagon: _HexagonBorder) -> Mesh:
    """The grid hexagon with its own connectivity, moved onto the border."""
    patch, pins = hexagon.patch(grid), layout.pin_points
    ring, outline = patch.index(hexagon.ring), hexagon.places(pins, grid.tolerance)
    number = np.zeros(len(patch.ij), dtype=np.int64)
    number[ring] = np.arange(len(ring))

    def to_outline(start: Ints, step: Ints) -> tuple[Ints, Floats]:
        count = hexagon.exit(start, step)
        return count, outline[number[patch.index(start + count[:, None] * step)]]

    stations = _arm_stations(layout, grid, to_outline)
    points = _moved(patch, stations, pins, ring, outline)
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
class _HexagonBorder:
    """A hexagon about a lattice point with its corners in the six lattice directions."""

    centre: Ints  # (2,) grid point
    rows: int  # grid edges from the centre to a corner, and along a side
    corners: Floats  # (6, 2) mm, in the order of GRID_DIRECTIONS
    ring: Ints  # (6 rows, 2) grid points on the outline, counterclockwise from the first corner

    @classmethod
    def of(cls, layout: Layout, grid: _LatticeGrid) -> _HexagonBorder | None:
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

    def patch(self, grid: _LatticeGrid) -> _GridPatch:
        """All grid points in the hexagon."""
        span = np.arange(-self.rows, self.rows + 1)
        ij = np.stack(np.meshgrid(span, span, indexing="ij"), axis=-1).reshape(-1, 2)
        return _GridPatch(grid, self.centre + ij[np.abs(ij.sum(axis=1)) <= self.rows])

    def exit(self, start: Ints, step: Ints) -> Ints:
        """(n,) number of grid edges from grid points (n, 2) to the outline, in directions (n, 2)."""
        at = start - self.centre
        faces = np.array([[one[:, 0], one[:, 1], one.sum(axis=1)] for one in (at, step)])
        left = self.rows - faces[0] * faces[1]
        return np.asarray(np.where(faces[1] != 0, left, left.max(initial=0)).min(axis=0))

    def places(self, pins: Floats, tolerance: float) -> Floats:
        """Places (6 rows, 2) of the ring: evenly spaced between corners, and pins (P, 2) mm that are on the outline."""
        taken: dict[int, float] = {q * self.rows: float(q * self.rows) for q in range(6)}
        for point in pins[distance_to_outline(pins, self.corners) <= tolerance]:
            at = self._along(point)
            if not any(abs(at - t) < 1e-5 for t in taken.values()):
                station = round(at) % len(self.ring)
                if station in taken:
                    raise MeshError("two pins or corners on the outline need the same mesh vertex")
                taken[station] = at
        ordered = sorted(taken)
        stations, along = np.array([*ordered, len(self.ring)]), np.array([*(taken[k] for k in ordered), len(self.ring)])
        if (np.diff(along) <= 0).any():
            raise MeshError("pins on the outline are closer together than the mesh edges")
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


def _cut_mesh(layout: Layout, grid: _LatticeGrid, enough: float = np.inf) -> Mesh:
    """The grid with its points moved onto arms and pins, cut off at the border and triangulated with it.

    The strip along the border is smoothed until all angles are `enough` (degrees).
    """
    pins = layout.pin_points
    inner_pins = pins[distance_to_outline(pins, layout.outline) > grid.tolerance]
    patch = _patch_around(layout, grid)
    stations = _arm_stations(layout, grid)
    points = _moved(patch, stations, inner_pins)

    arms = patch.paths(stations.arms)
    points, arms = _halved(points, arms, layout, grid.edge_mm)
    fixed = np.zeros(len(points), dtype=bool)
    fixed[np.concatenate([patch.index(stations.centres), *arms])] = True
    fixed[cKDTree(points).query(inner_pins)[1]] = True
    distance = distance_to_outline(points, layout.outline)
    within = inside(points, layout.outline)
    # pins on the outline are not among the fixed points
    if (fixed & ~(within & (distance >= 0.1 * grid.edge_mm))).any():
        raise MeshError("an arm or a pin is closer to the outline than a mesh edge allows")
    outline = outline_points(layout.outline, grid.edge_mm, pins, grid.tolerance, points[fixed])
    # free grid points keep their distance from the outline
    keep = within & (distance > 0.7 * grid.edge_mm) | fixed
    vertex = np.full(len(points), -1)
    vertex[keep] = np.arange(keep.sum()) + len(outline)
    rods = tuple(vertex[arm] for arm in arms)
    border = np.arange(len(outline))
    segments = np.concatenate(
        [np.column_stack([border, np.roll(border, -1)]), *(np.column_stack([r[:-1], r[1:]]) for r in rods)]
    )
    # points close to the outline are smoothed
    still = np.concatenate([np.ones(len(outline), dtype=bool), fixed[keep] | (distance[keep] > 2.6 * grid.edge_mm)])
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


def _patch_around(layout: Layout, grid: _LatticeGrid) -> _GridPatch:
    """Grid points on the sheet, and enough around it for every arm and for moves across the outline."""
    ij = grid.window(layout.outline.min(axis=0), layout.outline.max(axis=0))
    places = grid.place(ij)
    near = inside(places, layout.outline)
    near[~near] = distance_to_outline(places[~near], layout.outline) < 2 * grid.edge_mm
    return _GridPatch(grid, ij[near])


def _halved(points: Floats, arms: list[Ints], layout: Layout, edge_mm: float) -> tuple[Floats, list[Ints]]:
    """Halve the edges of arms that end just inside the outline, where triangles must be small; points are added."""
    gap = distance_to_outline(layout.arm_tip, layout.outline)
    arms = list(arms)
    for arm in np.flatnonzero((gap > ON_LINE_TOLERANCE * edge_mm) & (gap < 0.3 * edge_mm)):
        start, end = arms[arm][:-1], arms[arm][1:]
        arms[arm] = np.append(np.column_stack([start, len(points) + np.arange(len(start))]).ravel(), end[-1])
        points = np.concatenate([points, (points[start] + points[end]) / 2])
    return points, arms


def _smoothed(points: Floats, segments: Ints, still: NDArray[np.bool_], enough: float) -> tuple[Floats, Ints]:
    """Triangulate, and move the points that are not still to where their triangles are best, a few times."""
    # points are added beside tips that end close to the outline
    points, triangles = triangulate(points, segments, min_angle_deg=28.0)
    still = np.pad(still, (0, len(points) - len(still)))
    best, best_angle = (points, triangles), triangle_angles(points, triangles).min()
    for _ in range(4):
        if best_angle >= enough:
            break
        points = np.where(still[:, None], points, mean_circumcentres(points, triangles))
        points, triangles = triangulate(points, segments)
        angle = triangle_angles(points, triangles).min()
        if angle > best_angle:
            best, best_angle = (points, triangles), angle
    return best


@dataclass(frozen=True)
class _LatticeGrid:
    """Points `origin + ij @ basis / k` for whole numbers ij, each lattice triangle cut into k^2."""

    origin: Floats  # (2,) mm
    basis: Floats  # (2, 2) mm, rows: lattice vectors at most 90 degrees apart, the second to the left of the first
    k: int  # grid edges between neighbouring lattice points

    @classmethod
    def of(cls, layout: Layout, edge_mm: float) -> _LatticeGrid:
        """The grid of a layout whose edges are closest to `edge_mm`.

        Right-angled cells have an even number of them: the mirror lines between stars are grid lines. The mesh has
        their symmetry, unless tips that nearly touch need points that the triangulation adds.
        """
        a, b = np.asarray(layout.lattice_vectors, dtype=float)
        each = 2 if _is_right_angled(a, b) else 1
        k = max(each * round(float(np.sqrt((a @ a + b @ b) / 2)) / edge_mm / each), 2)
        return cls(np.asarray(layout.lattice_origin, dtype=float), np.array([a, b]), k)

    @cached_property
    def right_angled(self) -> bool:
        """The cells are squares or rectangles, whose two diagonals are equally long."""
        return _is_right_angled(*self.basis)

    @cached_property
    def edge_mm(self) -> float:
        """Length of a grid edge (mean of the two axes)."""
        return float(np.linalg.norm(self.basis, axis=1).mean() / self.k)

    @property
    def tolerance(self) -> float:
        """mm, places closer than this are the same but for rounding."""
        return ON_LINE_TOLERANCE * self.edge_mm * self.k

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


def _is_right_angled(a: Floats, b: Floats) -> bool:
    """Whether two lattice vectors (2,) are perpendicular."""
    return bool(abs(a @ b) < ON_LINE_TOLERANCE * (a @ a))


class _GridPatch:
    """Some points of a grid, the triangles and edges between them, and the way back from grid coordinates."""

    def __init__(self, grid: _LatticeGrid, ij: Ints) -> None:
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
        # the small weight keeps points in place if no path connects them to a known point
        between = diags_array(joins.sum(axis=1) + 1e-9) - joins[:, free]
        factor = splu(between.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        result[free] = factor.solve(joins @ result)
        return result


@dataclass(frozen=True)
class _Stations:
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


# from grid points and directions (A, 2), the number (A,) of grid edges to the outline and the places (A, 2) mm there
_ToOutline = Callable[[Ints, Ints], tuple[Ints, Floats]]


def _arm_stations(layout: Layout, grid: _LatticeGrid, to_outline: _ToOutline | None = None) -> _Stations:
    """Spread every arm evenly over grid edges, and the gap behind its tip over those left on its link."""
    links, centres = _links(layout, grid, to_outline), grid.centres(layout)
    centre, tip, length = layout.centres[layout.arm_star], layout.arm_tip, layout.arm_length
    other = _others(links)
    facing = other >= 0
    overlap = facing & (length + length[other] > np.linalg.norm(links.end - centre, axis=1) + grid.tolerance)
    if overlap.any():
        one = int(np.argmax(overlap))
        raise MeshError(f"arms {one} and {other[one]} overlap")
    meeting = np.linalg.norm(tip[other] - tip, axis=1) <= grid.tolerance
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
    return _Stations(centres, arms, np.concatenate(ij), np.concatenate(places))


def _links(layout: Layout, grid: _LatticeGrid, to_outline: _ToOutline | None) -> _ArmLinks:
    """The link of every arm: up to the next lattice point, or to the outline. No arm is longer than the spacing."""
    start, step, length = grid.centres(layout)[layout.arm_star], grid.directions(layout), layout.arm_length
    centre = layout.centres[layout.arm_star]
    spacing = np.linalg.norm(step @ grid.basis, axis=1)
    count = np.full(len(length), grid.k)
    end = grid.place(start + count[:, None] * step)
    if to_outline is not None:
        edges, there = to_outline(start, step)
        cut = edges < count
        count[cut], end[cut] = edges[cut], there[cut]
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


def _moved(
    patch: _GridPatch, stations: _Stations, pins: Floats, ring: Ints | None = None, outline: Floats | None = None
) -> Floats:
    """Places (n, 2) of all points of a patch: on arms, in gaps, on each pin, and the others smoothly between.

    Parameters
    ----------
    pins : (P, 2) mm; each gets the nearest point that is on no arm.
    ring, outline : (R,) points on the outline, and their places (R, 2) mm.
    """
    at = patch.index(stations.ij)
    taken, places = np.zeros(len(patch.ij), dtype=bool), patch.grid.place(patch.ij)
    if ring is not None:
        taken[ring], places[ring] = True, outline
    known = taken.copy()
    known[at[at >= 0]] = True
    places[at[at >= 0]] = stations.places[at >= 0]
    if np.abs(places[at] - stations.places)[at >= 0].max(initial=0) > patch.grid.tolerance:
        raise MeshError("two arms need the same grid point")
    printed = patch.index(np.concatenate([stations.centres, *stations.arms]))
    if printed.min(initial=0) < 0:
        raise MeshError("a star or an arm leaves the sheet")
    taken[printed] = True
    points = _spread(patch, known, places)
    missing = pins[cKDTree(points[taken]).query(pins)[0] > PIN_VERTEX_TOLERANCE_MM] if len(pins) else pins
    for pin in missing:
        away = np.where(taken, np.inf, np.linalg.norm(points - pin, axis=1))
        nearest = int(np.argmin(away))
        if away[nearest] > patch.grid.edge_mm:
            raise MeshError(f"no free grid point near the pin at ({pin[0]:g}, {pin[1]:g}) mm")
        taken[nearest], known[nearest], places[nearest] = True, True, pin
    return _spread(patch, known, places) if len(missing) else points


def _spread(patch: _GridPatch, known: NDArray[np.bool_], places: Floats) -> Floats:
    """All points, evenly between the known ones."""
    natural = patch.grid.place(patch.ij)
    points = natural + patch.harmonic(known, places - natural)
    return points + _off_squares(patch, known) if patch.grid.right_angled else points


def _off_squares(patch: _GridPatch, known: NDArray[np.bool_]) -> Floats:
    """(n, 2) mm by which free points leave exact squares, whose two diagonals are equally good, symmetrically.

    With offsets (u, v) from a lattice point, in lattice vectors, the points move along the gradient of
    `sin^2(pi u) sin^2(pi v)`. Its mixed derivative has one sign between two mirror lines, so that the diagonals there
    are parallel, and mirrored beyond.
    """
    u, v = (np.pi * patch.ij / patch.grid.k).T
    along = np.column_stack([np.sin(2.0 * u) * np.sin(v) ** 2, np.sin(u) ** 2 * np.sin(2.0 * v)])
    # a shift far above rounding, and invisible
    return np.where(known[:, None], 0.0, 1e-6 / patch.grid.k * along @ patch.grid.basis)
