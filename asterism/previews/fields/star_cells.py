"""How much each star has a say at a place of the sheet: its cell, smoothed.

The cell of a star are the places nearer to it than to any other site of its lattice, on the sheet. What no star's cell
covers is bare fabric: the rim, and sites without a star. A shell on coarse triangles needs fields without jumps, so
every place takes the mean over its neighbourhood with the weights `exp(-r^2/(2 w^2))` of a Gaussian, counting only what
is on the sheet.

**How far a star reaches.** Long arms leave their cell, and the fabric beyond the border's stars is not bare there: w is
a fifth of the spacing. Stars with short arms keep to their cells, and the rim around them is bare: w is as small as
the grid allows. In between a place takes the mean of both, by the length of the arms around it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial

import numpy as np
import scipy.sparse as sp

from asterism.previews.fields.cell_grid import MIN_SHARE_OFF_SHEET, CellGrid
from asterism.previews.model import PREVIEW_MODEL, PreviewModel
from equilibrium.compiled import formula, loop
from pattern.design.lattice import Lattice
from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout

GRID_POINTS_PER_SPACING = 20
GAUSSIAN_REACH = 3.0  # widths, where the Gaussian ends
MAX_STARS = 24  # that share a place


class Shares:
    """Of n places, whatever the length of the arms; each width is looked at when arms ask for it.

    Parameters
    ----------
    by_width : gives the (n, S) share of each star by a width of the Gaussian, in mm; what is missing to 1 is bare
        fabric.
    widths : wide and narrow.
    spacing_mm : of the stars.
    """

    def __init__(
        self,
        by_width: Callable[[float], sp.csr_matrix],
        widths: tuple[float, float],
        spacing: float,
        model: PreviewModel = PREVIEW_MODEL,
    ) -> None:
        self._by_width, self._widths, self.spacing_mm, self._model = by_width, widths, spacing, model

    @cached_property
    def wide(self) -> sp.csr_matrix:
        """(n, S) of stars with long arms."""
        return self._by_width(self._widths[0])

    @cached_property
    def narrow(self) -> sp.csr_matrix:
        """(n, S) of stars with short arms."""
        return self._by_width(self._widths[1])

    def __call__(self, length: Floats) -> sp.csr_matrix:
        """(n, S) share of each star, its arms being of a length (S,) mm."""
        long = long_arms(length, self.spacing_mm, self._model)
        if (long == 1.0).all():
            return self.wide
        part = (self.wide @ long) / np.maximum(self.wide @ np.ones(len(long)), MIN_SHARE_OFF_SHEET)
        return sp.csr_matrix(_scaled(self.wide, part) + _scaled(self.narrow, 1.0 - part))


def long_arms(length: Floats, spacing: float, model: PreviewModel = PREVIEW_MODEL) -> Floats:
    """(n,) how far arms of a length (n,) leave their cell: 0 for short ones, up to 1."""
    return np.clip((length / spacing - model.short_arm) / (model.long_arm - model.short_arm), 0.0, 1.0)


def _scaled(matrix: sp.csr_matrix, rows: Floats) -> sp.csr_matrix:
    """Every row times a number."""
    data = matrix.data * np.repeat(rows, np.diff(matrix.indptr))
    return sp.csr_matrix((data, matrix.indices, matrix.indptr), shape=matrix.shape)


class StarCells:
    """The smoothed cells of a layout's stars.

    Parameters
    ----------
    model : with the widths of the Gaussian.

    Attributes
    ----------
    width_mm : the wider one.
    """

    def __init__(self, layout: Layout, lattice: Lattice, model: PreviewModel = PREVIEW_MODEL) -> None:
        self._spacing = lattice.spacing_mm
        self._model = model
        self._widths = model.wide_smoothing * lattice.spacing_mm, model.narrow_smoothing * lattice.spacing_mm
        self.width_mm = self._widths[0]
        self._stars = len(layout.centres)
        step = min(lattice.spacing_mm / GRID_POINTS_PER_SPACING, self._widths[1] / 1.5)
        self._grid = CellGrid(layout, lattice, step, GAUSSIAN_REACH * self.width_mm)

    def shares(self, points: Floats) -> Shares:
        """Of the stars at printed points (n, 2) mm."""
        return Shares(partial(self._weights, points), self._widths, self._spacing, self._model)

    def _weights(self, points: Floats, width: float) -> sp.csr_matrix:
        """(n, S) share of each star."""
        grid = self._grid
        place = (np.asarray(points, dtype=float) - grid.origin) / grid.step
        star, share = np.empty(len(place) * MAX_STARS, dtype=np.int32), np.empty(len(place) * MAX_STARS)
        ends = np.zeros(len(place) + 1, dtype=np.int32)
        reach = int(np.ceil(GAUSSIAN_REACH * width / grid.step))
        own = grid.owner, grid.count, grid.ends
        _gather(place, *own, reach, grid.step / width, self._stars, star, share, ends)
        star, share = star[: ends[-1]].copy(), share[: ends[-1]].copy()
        return sp.csr_matrix((share, star, ends), shape=(len(place), self._stars))


@formula
def _bell(start, step, out):  # type: ignore[no-untyped-def]
    """exp(-r^2/2) at evenly spaced r: ratios of neighbours have one ratio."""
    value, ratio = np.exp(-0.5 * start * start), np.exp(-step * (start + 0.5 * step))
    turn = np.exp(-step * step)
    for k in range(out.size):
        out[k] = value
        value *= ratio
        ratio *= turn


@loop
def _gather(place, owner, count, ends, reach, step, stars, star, share, rows):  # type: ignore[no-untyped-def]
    """Who owns the grid around each place (n, 2), by the Gaussian's weight: star and share row by row, rows (n + 1,).

    `ends`: where along its row the run of equal owners and counts ends that a grid point is in. Owner S is nobody.
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
