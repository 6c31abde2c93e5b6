"""The triangular grid that refines the lattice of the stars, so that arms along lattice directions lie on its lines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, diags_array
from scipy.sparse.linalg import splu

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import cross_2d
from asterism.pattern.geometry.plane_lattice import GRID_DIRECTIONS
from asterism.pattern.layout.layout import Layout

# points this close to a grid line are on it, in spacings
ON_LINE_TOLERANCE = 1e-6
# small weight that keeps points in place if no path connects them to a known point
HOLDING_WEIGHT = 1e-9


@dataclass(frozen=True)
class LatticeGrid:
    """Points `origin + ij @ basis / k` for whole numbers ij, each lattice triangle cut into k^2.

    Attributes
    ----------
    origin : (2,) mm.
    basis : (2, 2) mm, rows: lattice vectors at most 90 degrees apart, the second to the left of the first.
    k : grid edges between neighbouring lattice points.
    """

    origin: Floats
    basis: Floats
    k: int

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
