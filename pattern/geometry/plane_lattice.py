"""Plane lattices: their shortest basis, their sites, and which sites are neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from asterism.equilibrium.arrays import Floats

# The six directions to the nearest sites, in multiples of the lattice vectors, counterclockwise.
GRID_DIRECTIONS = np.array([[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1]])


@dataclass(frozen=True)
class PlaneLattice:
    """All points `cell @ vectors + origin` for whole numbers `cell`.

    >>> lattice = PlaneLattice(10.0 * np.eye(2), np.zeros(2))
    >>> lattice.nearest(np.array([[18.0, 4.0]])).tolist()
    [[2, 0]]
    >>> lattice.neighbours(np.array([[0, 0], [1, 0], [1, 1]])).tolist()
    [[0, 1], [1, 2]]
    """

    vectors: Float[np.ndarray, "2 2"]  # (2, 2) mm, rows: the shortest basis, see `shortest_basis`
    origin: Float[np.ndarray, " 2"]  # (2,) mm, the site of cell (0, 0)

    def place(self, cells: Int[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
        """(n, 2) mm, sites of the lattice cells (n, 2)."""
        return np.asarray(cells @ self.vectors + self.origin)

    def cells_within(self, low: Float[np.ndarray, " 2"], high: Float[np.ndarray, " 2"]) -> Int[np.ndarray, "n 2"]:
        """(n, 2) all lattice cells whose sites lie in the box from `low` to `high` (mm), and some around it."""
        box = np.array([[x, y] for x in (low[0], high[0]) for y in (low[1], high[1])])
        corners = (box - self.origin) @ np.linalg.inv(self.vectors)
        first, last = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0))
        i, j = (np.arange(a, b + 1, dtype=np.int64) for a, b in zip(first, last, strict=True))
        return np.stack(np.meshgrid(i, j, indexing="ij"), axis=-1).reshape(-1, 2)

    def nearest(self, points: Float[np.ndarray, "n 2"]) -> Int[np.ndarray, "n 2"]:
        """(n, 2) the lattice cell whose site is nearest to each of the points (n, 2) mm."""
        # Triangles of a shortest basis are not obtuse: the nearest site is one of the four around the point.
        place = (points - self.origin) @ np.linalg.inv(self.vectors)
        low = np.floor(place)
        corners = np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
        sites = corners @ self.vectors
        # squared distances, without the part that is the same for all four sites
        squared = (sites**2).sum(axis=1)[:, None] - 2.0 * (sites @ self.vectors.T) @ (place - low).T
        best, smallest = np.zeros(len(place), dtype=np.int64), squared[0]
        for corner in range(1, 4):  # several times as fast as argmin
            best[squared[corner] < smallest] = corner
            smallest = np.minimum(smallest, squared[corner])
        return np.asarray(low.astype(np.int64) + corners.take(best, axis=0))

    def neighbours(self, cells: Int[np.ndarray, "n 2"]) -> Int[np.ndarray, "N 2"]:
        """(N, 2) pairs of rows of `cells` (n, 2) whose distance is at most the longer basis vector.

        The second cell of a pair is on the right of the first, or straight above it. So the pairs do not depend on the
        choice of the basis.
        """
        offsets = np.array([[i, j] for i in range(-2, 3) for j in range(-2, 3)])
        steps = offsets @ self.vectors
        ahead = np.where(np.abs(steps[:, 0]) > 1e-6, steps[:, 0], steps[:, 1]) > 1e-6
        offsets, distance = offsets[ahead], np.linalg.norm(steps[ahead], axis=1)
        reach = np.linalg.norm(self.vectors, axis=1).max()
        if len(cells) == 0:
            return np.empty((0, 2), dtype=np.int64)
        first = cells.min(axis=0) - 2
        row = np.full(cells.max(axis=0) - first + 3, -1)
        row[tuple((cells - first).T)] = np.arange(len(cells))
        near = cells[:, None] - first + offsets[distance <= reach * (1 + 1e-6)]
        other = np.sort(row[near[..., 0], near[..., 1]], axis=1)
        star, place = np.nonzero(other >= 0)
        return np.column_stack([star, other[star, place]])


def shortest_basis(basis: Floats) -> Float[np.ndarray, "2 2"]:
    """(2, 2) the shortest basis of a plane lattice, by Lagrange's reduction of any basis (2, 2).

    The second vector lies 60 to 90 degrees to the left of the first. Their difference is the third shortest step.

    >>> shortest_basis(np.array([[10.0, 0.0], [30.0, 12.0]])).tolist()
    [[10.0, 0.0], [0.0, 12.0]]
    """
    a, b = np.asarray(basis, dtype=float)
    while True:
        if a @ a > b @ b:
            a, b = b, a
        steps = np.round(a @ b / (a @ a))
        shorter = b - steps * a
        # Halfway between two steps, rounding would alternate for ever.
        if shorter @ shorter >= (1.0 - 1e-12) * (b @ b):
            break
        b = shorter
    if a @ b < -1e-9 * (a @ a):
        b = -b
    return np.array([a, b] if np.linalg.det([a, b]) > 0 else [b, a])
