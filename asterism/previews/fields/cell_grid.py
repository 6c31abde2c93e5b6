"""A fine grid over the sheet: the star whose cell holds each point, and whether the point is on the sheet."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.compiled import formula, loop
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.layout.layout import Layout

# weight of a grid point outside of the sheet; it only matters in tongues that are narrower than the step of the grid
MIN_SHARE_OFF_SHEET = 1e-6
# a point this near to the outline, in steps of the grid, is on the outline and does not count as inside
OUTLINE_TOLERANCE = 1e-9


class CellGrid:
    """A grid over a sheet and a margin around it, in rows along y.

    Parameters
    ----------
    step : mm between grid points.
    margin : width of the margin in mm; rounded up to whole steps.

    Attributes
    ----------
    origin : (2,) mm, the first grid point. The origin of the lattice is halfway between grid points, so that a star and
        its mirror image have mirrored grid points.
    owner : (n, m) star whose cell holds each point, S for bare fabric.
    count : (n, m) weight of each point: 1 on the sheet, MIN_SHARE_OFF_SHEET elsewhere.
    ends : (n, m) index, in the row of each point, of the next point with another owner or weight.
    """

    def __init__(self, layout: Layout, lattice: Lattice, step: float, margin: float) -> None:
        self.step = step
        margin = (np.ceil(margin / step) + 1) * step
        low, high = layout.outline.min(axis=0) - margin, layout.outline.max(axis=0) + margin
        middle = np.asarray(lattice.origin_mm) + 0.5 * step
        self.origin = middle + step * np.floor((low - middle) / step)
        shape = np.ceil((high - self.origin) / step).astype(int) + 1
        cells = lattice.sites.nearest(layout.centres)
        first = cells.min(axis=0) - 1
        star = np.full(cells.max(axis=0) - first + 2, len(cells))
        star[tuple((cells - first).T)] = np.arange(len(cells))
        self.owner, self.count = np.empty(shape, dtype=np.int64), np.empty(shape)
        self.ends = np.empty(shape, dtype=np.int64)
        vectors = lattice.vectors
        at = self.origin - np.asarray(lattice.origin_mm)
        lattice_of = at, np.linalg.inv(vectors), vectors, first, star
        _fill(step, *lattice_of, self.origin, layout.edges.start, layout.edges.end, self.owner, self.count, self.ends)


@loop
def _fill(step, at, inverse, vectors, first, star, origin, edge_start, edge_end, owner, count, ends):  # type: ignore[no-untyped-def]
    _fill_owners(at, step, inverse, vectors, first, star, owner)
    _fill_count(origin, step, edge_start, edge_end, count)
    _fill_ends(owner, count, ends)


@formula
def _fill_owners(origin, step, inverse, vectors, first, star, owner):  # type: ignore[no-untyped-def]
    """Set the owner of each grid point: the star at the nearest of the four lattice points around it.

    Four candidates are enough, since the triangles of a shortest lattice basis are not obtuse. `star` holds the number
    of each star at its lattice indices minus `first`, with a frame of bare cells around.
    """
    corner, square = np.empty((4, 2)), np.empty(4)
    for k in range(4):
        for a in range(2):
            corner[k, a] = (k // 2) * vectors[0, a] + (k % 2) * vectors[1, a]
        square[k] = corner[k, 0] ** 2 + corner[k, 1] ** 2
    for i in range(owner.shape[0]):
        x = origin[0] + i * step
        for j in range(owner.shape[1]):
            y = origin[1] + j * step
            u, v = x * inverse[0, 0] + y * inverse[1, 0], x * inverse[0, 1] + y * inverse[1, 1]
            low_u, low_v = np.floor(u), np.floor(v)
            dx = (u - low_u) * vectors[0, 0] + (v - low_v) * vectors[1, 0]
            dy = (u - low_u) * vectors[0, 1] + (v - low_v) * vectors[1, 1]
            best, least = 0, np.inf
            for k in range(4):
                far = square[k] - 2.0 * (corner[k, 0] * dx + corner[k, 1] * dy)
                if far < least:
                    best, least = k, far
            row = min(max(int(low_u) + best // 2 - first[0], 0), star.shape[0] - 1)
            column = min(max(int(low_v) + best % 2 - first[1], 0), star.shape[1] - 1)
            owner[i, j] = star[row, column]


@formula
def _fill_count(origin, step, edge_start, edge_end, count):  # type: ignore[no-untyped-def]
    """Set the weight of each point on the sheet whose edges run from (N, 2) to (N, 2).

    These are intersected with two lines for each row of the grid, directly below and above the row.
    """
    edges = edge_start.shape[0]
    crossings = np.empty(edges)
    for i in range(count.shape[0]):
        for j in range(count.shape[1]):
            count[i, j] = 1.0
        for side in (-OUTLINE_TOLERANCE, OUTLINE_TOLERANCE):
            x, filled = origin[0] + (i + side) * step, 0
            for k in range(edges):
                x1, y1 = edge_start[k]
                x2, y2 = edge_end[k]
                if (x1 <= x) != (x2 <= x):
                    y = y1 + (x - x1) / (x2 - x1) * (y2 - y1)
                    place = filled
                    while place > 0 and crossings[place - 1] > y:
                        crossings[place] = crossings[place - 1]
                        place -= 1
                    crossings[place] = y
                    filled += 1
            j = 0
            for k in range(0, filled, 2):
                below, above = (
                    (crossings[k] - origin[1]) / step + OUTLINE_TOLERANCE,
                    (crossings[k + 1] - origin[1]) / step - OUTLINE_TOLERANCE,
                )
                while j < count.shape[1] and j <= below:
                    count[i, j] = MIN_SHARE_OFF_SHEET
                    j += 1
                while j < count.shape[1] and j < above:
                    j += 1
            while j < count.shape[1]:
                count[i, j] = MIN_SHARE_OFF_SHEET
                j += 1


@formula
def _fill_ends(owner, count, ends):  # type: ignore[no-untyped-def]
    columns = owner.shape[1]
    for i in range(owner.shape[0]):
        ends[i, columns - 1] = columns
        for j in range(columns - 2, -1, -1):
            same = owner[i, j] == owner[i, j + 1] and count[i, j] == count[i, j + 1]
            ends[i, j] = ends[i, j + 1] if same else j + 1
