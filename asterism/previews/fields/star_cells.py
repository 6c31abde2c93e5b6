"""The share of each star at a place of the sheet: its lattice cell, smoothed by a Gaussian.

The cell of a star is the part of the sheet that is nearer to this star than to all other sites of the lattice. The rest
of the sheet is bare fabric: the rim, and sites without a star. The coarse shell needs fields without jumps. Therefore
the share at a place is the mean over its neighbourhood on the sheet, with the weights `exp(-r^2/(2 w^2))`.

**Width of the Gaussian.** Long arms reach beyond their cell and into the rim. Short arms stay within their cell, and
the rim around them is bare. So w is proportional to the length of the nearby arms, up to that of arms that reach half
way to the next star. The grid resolves widths from `MIN_WIDTH` on. For widths in between, the share is a mean of both.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.sparse as sp

from asterism.equilibrium.arrays import Bools, Floats, Ints
from asterism.equilibrium.compiled import formula, loop
from asterism.pattern.design.lattice import Lattice
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.previews.model import PREVIEW_MODEL, PreviewModel

# radius of a cell in spacings: the corners of a cell of the triangular lattice
CELL_RADIUS = 3.0**-0.5
# weight of a grid point outside of the sheet; it only matters in tongues that are narrower than the step of the grid
MIN_SHARE_OFF_SHEET = 1e-6
# smallest width of the Gaussian, in spacings: it takes one and a half steps of a grid that is still fast
MIN_WIDTH = 0.08
# arms of this length, in spacings, reach half way to the next star, where cells of long arms overlap
HALF_WAY = 0.5
# at most this many stars share a place
MAX_STARS = 24
# a place with a smaller share of stars counts as far from all stars
MIN_STAR_SHARE = 0.02


class StarCells:
    """The smoothed cells of the stars of a layout, on a grid over the sheet and a margin around it, in rows along y.

    `widths_mm` are the larger and the smaller width of the Gaussian, `step` the distance of grid points in mm, and
    `origin` (2,) mm the first of them. The origin of the lattice is halfway between grid points, so that a star and its
    mirror image have mirrored ones. For each point, `owner` (n, m) is the star whose cell holds it, S for bare fabric,
    `count` (n, m) its weight, 1 on the sheet and MIN_SHARE_OFF_SHEET elsewhere, and `ends` (n, m) the index in its row
    of the next point with another owner or weight.
    """

    # radius at which the Gaussian is cut off, in widths
    _reach = 3.0

    def __init__(self, layout: Layout, lattice: Lattice, model: PreviewModel = PREVIEW_MODEL) -> None:
        self.spacing_mm, self.model = lattice.spacing_mm, model
        self.widths_mm = HALF_WAY * model.smoothing_per_arm * lattice.spacing_mm, MIN_WIDTH * lattice.spacing_mm
        self.step = step = min(lattice.spacing_mm / 20, self.widths_mm[1] / 1.5)
        margin = (np.ceil(self._reach * self.widths_mm[0] / step) + 1) * step
        low, high = layout.outline.min(axis=0) - margin, layout.outline.max(axis=0) + margin
        middle = np.asarray(lattice.origin_mm) + 0.5 * step
        self.origin = middle + step * np.floor((low - middle) / step)
        shape = np.ceil((high - self.origin) / step).astype(int) + 1
        cells = lattice.sites.nearest(layout.centres)
        self._stars = len(cells)
        first = cells.min(axis=0) - 1
        star = np.full(cells.max(axis=0) - first + 2, len(cells))
        star[tuple((cells - first).T)] = np.arange(len(cells))
        points = self.origin + step * np.moveaxis(np.indices(shape), 0, -1).reshape(-1, 2)
        nearest = np.clip(lattice.sites.nearest(points) - first, 0, np.array(star.shape) - 1)
        self.owner = star[tuple(nearest.T)].reshape(shape)
        self.count = np.where(self._inside(layout.edges, shape), 1.0, MIN_SHARE_OFF_SHEET)
        changes = (np.diff(self.owner, axis=1) != 0) | (np.diff(self.count, axis=1) != 0.0)
        ends = np.full(shape, shape[1])
        ends[:, :-1][changes] = np.nonzero(changes)[1] + 1
        self.ends = np.ascontiguousarray(np.minimum.accumulate(ends[:, ::-1], axis=1)[:, ::-1])

    def _inside(self, edges: SheetEdges, shape: Ints) -> Bools:
        """(n, m) whether the points are on the sheet: between crossings of its edges with lines beside their rows."""
        inside = np.ones(shape, dtype=bool)
        # a point this near to the outline, in steps of the grid, is on the outline and does not count as inside
        near = 1e-9
        for side in (-near, near):
            x = self.origin[0] + (np.arange(shape[0]) + side) * self.step
            row, edge = np.nonzero((edges.start[:, 0] <= x[:, None]) != (edges.end[:, 0] <= x[:, None]))
            start, along = edges.start[edge], (edges.end - edges.start)[edge]
            place = (start[:, 1] + (x[row] - start[:, 0]) / along[:, 0] * along[:, 1] - self.origin[1]) / self.step
            passed = np.zeros((2, *shape), dtype=np.int16)
            np.add.at(passed[0], (row, np.floor(place + near).astype(int) + 1), 1)
            np.add.at(passed[1], (row, np.ceil(place - near).astype(int)), 1)
            safely, nearly = passed.cumsum(axis=2, dtype=np.int16)
            inside &= (safely % 2 == 1) & (safely == nearly)
        return inside

    def weights(self, points: Floats, width: float) -> sp.csr_matrix:
        """(n, S) share of each star at points (n, 2) mm, for a width in mm."""
        place = (points - self.origin) / self.step
        star, share = np.empty(len(place) * MAX_STARS, dtype=np.int32), np.empty(len(place) * MAX_STARS)
        ends = np.zeros(len(place) + 1, dtype=np.int32)
        reach = int(np.ceil(self._reach * width / self.step))
        own = self.owner, self.count, self.ends
        _gather(place, *own, reach, self.step / width, self._stars, star, share, ends)
        star, share = star[: ends[-1]].copy(), share[: ends[-1]].copy()
        return sp.csr_matrix((share, star, ends), shape=(len(place), self._stars))


class Shares:
    """Shares of S stars at n places (n, 2) mm, as a function of the length of the arms, from smoothed cells."""

    def __init__(self, cells: StarCells, points: Floats) -> None:
        self.cells, self._points = cells, np.asarray(points, dtype=float)

    @cached_property
    def wide(self) -> sp.csr_matrix:
        """(n, S) shares with the largest width."""
        return self.cells.weights(self._points, self.cells.widths_mm[0])

    @cached_property
    def narrow(self) -> sp.csr_matrix:
        """(n, S) shares with the smallest width."""
        return self.cells.weights(self._points, self.cells.widths_mm[1])

    def __call__(self, length: Floats) -> sp.csr_matrix:
        """(n, S) share of each star, for arm lengths (S,) in mm."""
        # the shares lie between the narrow ones (0) and the wide ones (1)
        shortest = MIN_WIDTH / self.cells.model.smoothing_per_arm
        long = np.clip((length / self.cells.spacing_mm - shortest) / max(HALF_WAY - shortest, 1e-9), 0.0, 1.0)
        if (long == 1.0).all():
            return self.wide
        both, row = self._both
        part = (self.wide @ long / np.maximum(stars_share(self.wide), MIN_SHARE_OFF_SHEET))[row]
        data = both.data.real * part + both.data.imag * (1.0 - part)
        return sp.csr_matrix((data, both.indices, both.indptr), shape=both.shape)

    @cached_property
    def _both(self) -> tuple[sp.csr_matrix, Ints]:
        """(n, S) wide shares as the real part and narrow ones as the imaginary part, and the row of each entry.

        Edits change the lengths only: the entries stay where they are.
        """
        both = sp.csr_matrix(self.wide + 1j * self.narrow)
        return both, np.repeat(np.arange(both.shape[0]), np.diff(both.indptr))


def stars_share(weights: sp.csr_matrix) -> Floats:
    """(n,) share of all stars together; bare fabric has the rest to 1."""
    return np.asarray(weights @ np.ones(weights.shape[1]))


def shared(weights: sp.csr_matrix, of: Floats) -> Floats:
    """(n, ...) weighted mean of values (S + 1, ...) of the stars and, last, of bare fabric."""
    more = (of[:-1] - of[-1]).reshape(len(of) - 1, -1)
    return np.asarray(of[-1] + (weights @ more).reshape(-1, *of.shape[1:]))


def beside(weights: sp.csr_matrix, of: Floats, nearest: Ints | None = None) -> Floats:
    """(n, ...) mean of values (S, ...) over the stars near each place.

    Far from all stars, it is the value of the `nearest` star (n,), or zero if `nearest` is not given.
    """
    mean = weights @ of
    share = stars_share(weights).reshape(-1, *[1] * (mean.ndim - 1))
    if nearest is None:
        return np.asarray(mean / np.maximum(share, MIN_STAR_SHARE))
    return np.asarray((mean + MIN_STAR_SHARE * of[nearest]) / (share + MIN_STAR_SHARE))


@formula
def _bell(start, step, out):  # type: ignore[no-untyped-def]
    """Set out to exp(-r^2/2) at evenly spaced r, by recurrence: the ratio of neighbours is a geometric sequence."""
    value, ratio = np.exp(-0.5 * start * start), np.exp(-step * (start + 0.5 * step))
    turn = np.exp(-step * step)
    for k in range(out.size):
        out[k] = value
        value *= ratio
        ratio *= turn


@loop
def _gather(place, owner, count, ends, reach, step, stars, star, share, rows):  # type: ignore[no-untyped-def]
    """Sum the Gaussian's weights around each place (n, 2) by the owner of the grid points.

    The result is a CSR matrix: `star` and `share` hold its columns and values, `rows` (n + 1,) its row pointer.
    `ends` is the index in its row at which a run of grid points with equal owner and weight ends. Owner S is bare
    fabric.
    """
    size = 2 * reach + 1
    first, across, along = np.empty(2, dtype=np.int64), np.empty(size), np.zeros(size + 1)
    for p in range(place.shape[0]):
        for a in range(2):
            first[a] = min(max(int(np.rint(place[p, a])), reach), owner.shape[a] - reach - 1) - reach
        _bell((first[0] - place[p, 0]) * step, step, across)
        _bell((first[1] - place[p, 1]) * step, step, along[1:])
        for k in range(size):
            along[k + 1] += along[k]
        total, begin, last = 0.0, rows[p], rows[p]
        for i in range(size):
            row, j = first[0] + i, 0
            while j < size:
                who, weight = owner[row, first[1] + j], across[i] * count[row, first[1] + j]
                end = min(ends[row, first[1] + j] - first[1], size)
                weight *= along[end] - along[j]
                j = end
                total += weight
                if who == stars:
                    continue
                k = begin
                while k < last and star[k] != who:
                    k += 1
                if k == last:
                    if last == begin + MAX_STARS:
                        continue
                    star[k], share[k], last = who, 0.0, last + 1
                share[k] += weight
        for k in range(begin, last):
            share[k] /= total
        rows[p + 1] = last
