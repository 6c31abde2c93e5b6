"""Where the grid points of an aligned cell lie: on the arms, between them, and closer together at arms if graded."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import spsolve

from asterism.equilibrium.arrays import Floats, Ints
from asterism.homogenize.cell.periodic_mesh import TOUCHING_TOLERANCE
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from asterism.pattern.mesh.grading import Grading


@dataclass(frozen=True)
class LinkStations:
    """Grid points on the links from a star to its six neighbours.

    Attributes
    ----------
    segments : (6,) edges of the arm in each direction; 0 without an arm.
    fractions : (6, k + 1) places of the points, over the distance to the neighbour.
    known : (6, k + 1) whether a point stays at its place; the others lie evenly between those around.
    """

    segments: Ints
    fractions: Floats
    known: NDArray[np.bool_]


def link_reach(lattice_vectors: Floats, directions: Ints, lengths: Floats) -> Floats:
    """(6,) length of the arm in each direction over the distance to the neighbour; 0 without an arm."""
    reach = np.zeros(6)
    reach[directions] = lengths / np.linalg.norm(GRID_DIRECTIONS @ lattice_vectors, axis=1)[directions]
    return reach


def tips_meet(reach: Floats) -> NDArray[np.bool_]:
    """(6,) whether the tip meets the tip of the neighbour's arm."""
    back = np.roll(reach, 3)
    return (reach > 0) & (back > 0) & (reach + back > 1.0 - TOUCHING_TOLERANCE)


def link_stations(directions: Ints, reach: Floats, k: int, wanted: int | None) -> LinkStations:
    """Stations of an even mesh with k edges between stars.

    Parameters
    ----------
    reach : (6,), from `link_reach`.
    wanted : edges of every arm but those whose tips meet; the nearest number to its length by default.

    Raises
    ------
    MeshError
        Arms from both ends of a link overlap.
    """
    segments = np.zeros(6, dtype=np.int64)
    for direction in directions:
        # tips that do not meet are different points, whether there are arms from both ends or from one
        both, touches = reach[(direction + 3) % 6] > 0, reach[direction] > 1.0 - TOUCHING_TOLERANCE
        longest = (k - 1) // 2 if both else k if touches else k - 1
        segments[direction] = min(max(wanted or round(reach[direction] * k), 1), longest)
    segments[tips_meet(reach)] = k // 2
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


def cell_grading(lattice_vectors: Floats, directions: Ints, lengths: Floats, repeat: tuple[int, int]) -> Grading:
    """The grading by the arms of `repeat` cells and of those around."""
    steps = np.array([[i, j] for i in range(-1, repeat[0] + 2) for j in range(-1, repeat[1] + 2)])
    along = GRID_DIRECTIONS[directions] @ lattice_vectors
    arms = along * (lengths / np.linalg.norm(along, axis=1))[:, None]
    centres = np.repeat(steps @ lattice_vectors, len(arms), axis=0)
    spacing = float(np.linalg.norm(lattice_vectors, axis=1).min())
    return Grading.of_arms(centres, centres + np.tile(arms, (len(steps), 1)), spacing)


def graded_stations(
    links: LinkStations, along: Floats, directions: Ints, lengths: Floats, grading: Grading
) -> LinkStations:
    """The same numbers of edges; the vertices of an arm crowd at its tip, and those behind it are free.

    Parameters
    ----------
    along : (N, 2) mm, from the star to the neighbour that each arm points to.
    """
    fractions, known = links.fractions.copy(), np.zeros_like(links.known)
    known[:, [0, -1]] = True
    for direction, length, link in zip(directions, lengths, np.linalg.norm(along, axis=1), strict=True):
        count, back = links.segments[direction], (direction + 3) % 6
        place = length / link * grading.along(float(length), int(count))
        fractions[direction, : count + 1], known[direction, : count + 1] = place, True
        fractions[back, len(fractions[back]) - count - 1 :] = 1.0 - place[::-1]
        known[back, len(fractions[back]) - count - 1 :] = True
    return replace(links, fractions=fractions, known=known)


def grid_displacement(
    repeat: tuple[int, int], k: int, lattice_vectors: Floats, links: LinkStations, grading: Grading | None
) -> Floats:
    """(n m, 2) mm: points on links follow the arms, and every other point is the mean of its neighbours.

    Without a grading all neighbours count alike, else as `pattern.mesh.grading` states.
    """
    n, m = repeat[0] * k, repeat[1] * k
    size, number = n * m, np.arange(n * m).reshape(n, m)
    i, j = (index.ravel() for index in np.indices((n, m)))
    shift, known = np.zeros((size, 2)), np.zeros(size, dtype=bool)
    for direction in range(3):
        di, dj = GRID_DIRECTIONS[direction]
        for a in range(0, n, k):
            for b in range(0, m, k):
                along = np.arange(k + 1)
                points = number[(a + along * di) % n, (b + along * dj) % m]
                off = (links.fractions[direction] - along / k)[:, None] * (GRID_DIRECTIONS[direction] @ lattice_vectors)
                fixed = links.known[direction]
                shift[points[fixed]], known[points[fixed]] = off[fixed], True
    if known.all():
        return shift
    # of every point to its next ones in the first three directions
    start = np.tile(number.ravel(), 3)
    end = np.concatenate([number[(i + di) % n, (j + dj) % m] for di, dj in GRID_DIRECTIONS[:3]])
    step = np.repeat(GRID_DIRECTIONS[:3] @ lattice_vectors / k, size, axis=0)
    grid = np.column_stack([i, j]) @ lattice_vectors / k
    free = ~known

    def means(stiff: Floats) -> Floats:
        """The displacements (n m, 2), with weights (3 n m,) of the edges."""
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

    even = means(np.ones(3 * size))
    if grading is None:
        return even

    def middles(points: Floats) -> Floats:
        """The middles (3 n m, 2) of the edges."""
        off = points - grid
        return points[start] + 0.5 * (step + off[end] - off[start])

    points = grading.settled(grid + even, middles, lambda stiff: grid + means(stiff), float(np.linalg.norm(step[0])))
    return np.asarray(points - grid)
