"""The aligned mesh of a unit cell: a grid that refines the lattice, closed to a torus, with arms on its lines.

The cell is the parallelogram of the lattice vectors A1 and A2. Grid point (i, j) lies at `i A1/k + j A2/k`. Indices
are taken modulo the cell, and the quotient gives the lattice vectors to the image. The star sits at the corner. Its
arms run along A1, A2 or A2 - A1, in either sense, and may leave the cell.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.cell.periodic_mesh import TOUCHING_TOLERANCE, MeshPath, PeriodicMesh, PeriodicTriangles, tiled
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from asterism.pattern.mesh.graded_mesh import MIN_SPRING_WEIGHT, Grading, half_cotangents

# edges of a cell of bare fabric
BARE_EDGES = 4


def aligned_cell_mesh(
    lattice_vectors: Floats,
    directions: Ints,
    lengths: Floats,
    edge_mm: float,
    repeat: tuple[int, int] = (1, 1),
    surrounded: bool = False,
    graded: bool = False,
) -> PeriodicMesh:
    """Mesh of `repeat` cells with equal stars.

    Raises `MeshError` if arms from both ends of a link overlap.

    Parameters
    ----------
    lattice_vectors : (2, 2) mm, rows, as of `Lattice.vectors`.
    directions : (N,) of the arms, indices into `GRID_DIRECTIONS`.
    lengths : (N,) mm, up to the distance to the next star in that direction.
    edge_mm : of the grid, about.
    surrounded : with the triangles around, whose points are then unfolded too.
    graded : as many triangles, but finer ones at arms and tips, as in graded sheets (`pattern.mesh.graded_mesh`).
    """
    k = edges_per_spacing(lattice_vectors, directions, lengths, edge_mm)
    if not len(directions):  # bare fabric repeats from triangle to triangle, so a few of them are the whole cell
        lattice_vectors, k = lattice_vectors * BARE_EDGES / k, BARE_EDGES
    grading = _cell_grading(lattice_vectors, directions, lengths) if graded and len(directions) else None
    # edges of short arms on graded meshes: with fewer ones the curvature of such stars jumps by a quarter
    least = 4 if grading is not None else 1
    links = _link_stations(directions, _link_reach(lattice_vectors, directions, lengths), k, least)
    shift = _grid_displacement(k, lattice_vectors, links)
    if grading is not None:
        links = _graded_stations(links, GRID_DIRECTIONS[directions] @ lattice_vectors, directions, lengths, grading)
        shift = _grid_displacement(k, lattice_vectors, links, grading, shift)
    grid = np.indices((k, k)).reshape(2, -1).T

    def paths(steps: list[tuple[int, int]]) -> MeshPath:
        """Grid points so many steps away from each point of the cell, (k^2, n)."""
        places = grid[:, None] + np.array(steps)
        return MeshPath((places % k) @ [k, 1], places // k)

    halves = [paths([(0, 0), (1, 0), (0, 1)]), paths([(1, 0), (1, 1), (0, 1)])]
    corner, image = (np.concatenate([getattr(half, name) for half in halves]) for name in ("point", "image"))
    points = grid @ lattice_vectors / k + shift
    arms = []
    for direction in directions:
        along = np.arange(links.segments[direction] + 1)[:, None] * GRID_DIRECTIONS[direction]
        arms.append(MeshPath((along % k) @ [k, 1], along // k))
    return tiled(PeriodicTriangles(points, lattice_vectors, corner, image), repeat, arms, surrounded, of_stars=True)


def edges_per_spacing(lattice_vectors: Floats, directions: Ints, lengths: Floats, edge_mm: float) -> int:
    """Grid edges between adjacent stars, an even number if tips meet in the middle; see `aligned_cell_mesh`."""
    wish = float(np.linalg.norm(GRID_DIRECTIONS @ lattice_vectors, axis=1).min()) / edge_mm
    if _tips_meet(_link_reach(lattice_vectors, directions, lengths)).any():
        return max(4, 2 * round(wish / 2))
    return max(3, round(wish))


@dataclass(frozen=True)
class LinkStations:
    """Grid points on the links from a star to its six neighbours."""

    segments: Ints  # (6,) edges of the arm in each direction; 0 without an arm
    fractions: Floats  # (6, k + 1) places of the points, over the distance to the neighbour
    # (6, k + 1) whether a point stays at its place; the others lie evenly between those around.
    known: NDArray[np.bool_]


def _link_reach(lattice_vectors: Floats, directions: Ints, lengths: Floats) -> Floats:
    """(6,) length of the arm in each direction over the distance to the neighbour; 0 without an arm."""
    reach = np.zeros(6)
    reach[directions] = lengths / np.linalg.norm(GRID_DIRECTIONS @ lattice_vectors, axis=1)[directions]
    return reach


def _tips_meet(reach: Floats) -> NDArray[np.bool_]:
    """(6,) whether the tip meets the tip of the neighbour's arm."""
    back = np.roll(reach, 3)
    return (reach > 0) & (back > 0) & (reach + back > 1.0 - TOUCHING_TOLERANCE)


def _link_stations(directions: Ints, reach: Floats, k: int, least: int) -> LinkStations:
    """Stations of an even mesh with k edges between stars."""
    segments = np.zeros(6, dtype=np.int64)
    for direction in directions:
        # tips that do not meet are different points, whether there are arms from both ends or from one
        both, touches = reach[(direction + 3) % 6] > 0, reach[direction] > 1.0 - TOUCHING_TOLERANCE
        longest = (k - 1) // 2 if both else k if touches else k - 1
        segments[direction] = min(max(round(reach[direction] * k), least), longest)
    segments[_tips_meet(reach)] = k // 2
    fractions = np.empty((6, k + 1))
    for direction in range(6):
        back = (direction + 3) % 6
        near, far = segments[direction], segments[back]
        if near + far > k or reach[direction] + reach[back] > 1.0 + TOUCHING_TOLERANCE:
            raise MeshError("arms of neighbouring stars overlap")
        known = [0, near, k - far, k]
        place = [0.0, reach[direction], 1.0 - reach[back], 1.0]
        where = np.unique(known, return_index=True)[1]
        fractions[direction] = np.interp(np.arange(k + 1), np.array(known)[where], np.array(place)[where])
    return LinkStations(segments, fractions, np.ones(fractions.shape, dtype=bool))


def _cell_grading(lattice_vectors: Floats, directions: Ints, lengths: Floats) -> Grading:
    """The grading by the arms of a cell and of those around."""
    steps = np.array([[i, j] for i in range(-1, 3) for j in range(-1, 3)])
    along = GRID_DIRECTIONS[directions] @ lattice_vectors
    arms = along * (lengths / np.linalg.norm(along, axis=1))[:, None]
    centres = np.repeat(steps @ lattice_vectors, len(arms), axis=0)
    spacing = float(np.linalg.norm(lattice_vectors, axis=1).min())
    return Grading.of_arms(centres, centres + np.tile(arms, (len(steps), 1)), spacing)


def _graded_stations(
    links: LinkStations, along: Floats, directions: Ints, lengths: Floats, grading: Grading
) -> LinkStations:
    """The same numbers of edges; the vertices of an arm crowd at its tip, and those behind it are free."""
    fractions, known = links.fractions.copy(), np.zeros_like(links.known)
    known[:, [0, -1]] = True
    for direction, length, link in zip(directions, lengths, np.linalg.norm(along, axis=1), strict=True):
        count, back = links.segments[direction], (direction + 3) % 6
        place = length / link * grading.along(float(length), int(count))
        fractions[direction, : count + 1], known[direction, : count + 1] = place, True
        fractions[back, len(fractions[back]) - count - 1 :] = 1.0 - place[::-1]
        known[back, len(fractions[back]) - count - 1 :] = True
    return replace(links, fractions=fractions, known=known)


def _grid_displacement(
    k: int,
    lattice_vectors: Floats,
    links: LinkStations,
    grading: Grading | None = None,
    even: Floats | None = None,
) -> Floats:
    """(k^2, 2) mm: points on links follow the arms, and every other point is the mean of its neighbours.

    All neighbours count alike, or with a grading as in `pattern.mesh.graded_mesh`, from those of the even mesh.
    """
    size, number = k * k, np.arange(k * k).reshape(k, k)
    i, j = (index.ravel() for index in np.indices((k, k)))
    shift, known = np.zeros((size, 2)), np.zeros(size, dtype=bool)
    for direction in range(3):
        di, dj = GRID_DIRECTIONS[direction]
        along = np.arange(k + 1)
        points = number[(along * di) % k, (along * dj) % k]
        off = (links.fractions[direction] - along / k)[:, None] * (GRID_DIRECTIONS[direction] @ lattice_vectors)
        fixed = links.known[direction]
        shift[points[fixed]], known[points[fixed]] = off[fixed], True
    if known.all():
        return shift
    # of every point to its next ones in the first three directions
    start = np.tile(number.ravel(), 3)
    end = np.concatenate([number[(i + di) % k, (j + dj) % k] for di, dj in GRID_DIRECTIONS[:3]])
    step = np.repeat(GRID_DIRECTIONS[:3] @ lattice_vectors / k, size, axis=0)
    grid = np.column_stack([i, j]) @ lattice_vectors / k
    free = ~known

    def means(stiff: Floats) -> Floats:
        """The displacements (k^2, 2), with weights (3 k^2,) of the edges."""
        joins = sp.csr_matrix((stiff, (start, end)), shape=(size, size))
        joins = joins + joins.T
        laplacian = (sp.diags(np.asarray(joins.sum(axis=1)).ravel()) - joins).tocsc()
        pull = np.zeros((size, 2))
        np.add.at(pull, start, stiff[:, None] * step)
        np.add.at(pull, end, -stiff[:, None] * step)
        right = (pull - laplacian[:, known] @ shift[known])[free]
        moved = shift.copy()
        moved[free] = np.reshape(spsolve(laplacian[free][:, free].tocsc(), right), (-1, 2))
        return moved

    if grading is None or even is None:
        return means(np.ones(3 * size))
    # the neighbours around each point, from that before the first direction to that behind the third
    steps = GRID_DIRECTIONS[[5, 0, 1, 2, 3]]
    off = [(di, dj) @ lattice_vectors / k + even[number[(i + di) % k, (j + dj) % k]] - even for di, dj in steps]
    pairs = [sum(half_cotangents(off[q] - b, -b) for b in (off[q - 1], off[q + 1])) for q in (1, 2, 3)]
    weight = np.maximum(np.concatenate(pairs), MIN_SPRING_WEIGHT)

    def ends(points: Floats) -> tuple[Floats, Floats]:
        """Both ends (3 k^2, 2) of the edges, the second ones beside the first."""
        off = points - grid
        return points[start], points[start] + step + off[end] - off[start]

    points = grading.settled(
        grid + means(weight), ends, lambda stiff: grid + means(weight * stiff), float(np.linalg.norm(step[0]))
    )
    return np.asarray(points - grid)
