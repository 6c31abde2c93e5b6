"""Shares of the arms' moves in those of the fabric beside them, at fixed printed points.

Fabric at the distance q from an arm follows the arm by exp(-q/b). The shares of an arm depend on that arm alone, so an
edit that changes a few arms needs new shares of these only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop
from asterism.previews.arms import Arms

# the crease of exp(-q/b) on the arm is rounded over this multiple of b
CREASE_ROUNDING = 0.1
# fabric beyond a tip follows the arm up to this multiple of b
DECAY_LENGTHS = 4.0
# side of the cells in which points are listed, over the spacing: a tenth of an arm's reach
CELL_SPACINGS = 0.25


@dataclass(frozen=True, eq=False)
class ArmShares:
    """Shares of A arms at n points; made by `arm_shares`.

    Attributes
    ----------
    arms : the arms.
    cells : the points.
    reach : mm, distance from the middle of an arm up to which fabric follows it.
    along : (n, A) shares of the tips' moves along the sheet.
    """

    arms: Arms
    cells: PointCells
    reach: float
    along: sp.csc_matrix


@dataclass(frozen=True, eq=False)
class PointCells:
    """Points (n, 2) mm listed by square cells.

    Attributes
    ----------
    order : (n,) numbers of the points, cell by cell along y and then along x.
    points : (n, 2) the points in this order.
    to_pin : (n,) distance to the nearest supported point over that in which fabric follows an arm; at most 1.
    starts : (X, Y + 1) where the points of each cell begin in `order`.
    origin, size : (2,) mm, the corner of the first cell, and the side of a cell in mm.
    """

    order: Ints
    points: Floats
    to_pin: Floats
    starts: Ints
    origin: Floats
    size: float

    @classmethod
    def of(cls, points: Floats, size: float, pins: Floats, beside: float) -> PointCells:
        """Points in cells of a size in mm; `pins` (P, 2) and `beside` in mm give `to_pin`."""
        to_pin = cKDTree(pins).query(points)[0] / beside if len(pins) else np.ones(len(points))
        origin = points.min(axis=0, initial=np.inf) if len(points) else np.zeros(2)
        column, row = ((points - origin) / size).astype(np.int64).T
        columns, rows = (int(each.max(initial=0)) + 1 for each in (column, row))
        cell = column * rows + row
        ends = np.searchsorted(np.sort(cell), np.arange(columns * rows + 1))
        starts = np.column_stack([ends[:-1].reshape(columns, rows), ends[rows::rows]])
        order = np.argsort(cell, kind="stable")
        return cls(order, points[order], np.minimum(to_pin, 1.0)[order], starts, origin, size)


def arm_shares(arms: Arms, points: Floats, before: ArmShares | None = None) -> ArmShares:
    """The shares of all arms at points (n, 2) mm.

    Parameters
    ----------
    before : shares of other arms at these points, on a sheet with the same supported points. Those of arms that are
        the same are used again.
    """
    model, layout = arms.model, arms.layout
    beside, beyond = (b * layout.spacing_mm for b in (model.fabric_beside_arm, model.fabric_beyond_tip))
    reach = 0.5 * float(arms.length.max()) + DECAY_LENGTHS * beyond
    known, kept = np.zeros(len(arms.length), dtype=bool), (np.zeros(1, dtype=np.int32), np.empty(0, dtype=np.int32))
    shares = np.empty(0)
    if before is None:
        cells = PointCells.of(points, CELL_SPACINGS * layout.spacing_mm, layout.pin_points, beside)
    else:
        cells = before.cells
        if len(before.arms.length) == len(arms.length) and before.reach == reach:
            known = (before.arms.centre == arms.centre).all(axis=1) & (before.arms.tip == arms.tip).all(axis=1)
            kept = before.along.indptr, before.along.indices
            shares = before.along.data
    given = cells.order, cells.points, cells.to_pin, cells.starts, cells.origin, cells.size
    of_arms = arms.centre, arms.direction, arms.length, arms.room, known, *kept, shares, beside, beyond, reach
    starts = np.zeros(len(known) + 1, dtype=np.int32)
    _follow(*given, *of_arms, starts, np.empty(0, dtype=np.int32), np.empty(0))
    starts = np.cumsum(starts, dtype=np.int32)
    point, share = np.empty(starts[-1], dtype=np.int32), np.empty(starts[-1])
    _follow(*given, *of_arms, starts, point, share)
    return ArmShares(arms, cells, reach, sp.csc_matrix((share, point, starts), (len(points), len(known))))


@loop
def _follow(  # type: ignore[no-untyped-def]
    order, points, to_pin, cells, origin, size, centre, direction, length, room,
    known, old_starts, old_point, old_share, beside, beyond, reach, starts, point, share,
):  # fmt: skip
    """Set the CSC arrays: row indices `point` (m,) and values `share` (m,) behind the column pointer `starts`.

    If `point` is empty, `starts[a + 1]` is set to the number of entries of arm a instead. Columns of `known` arms are
    copied from the old arrays.
    """
    per_beside, per_beyond = 1.0 / beside, 1.0 / beyond
    for a in range(length.size):
        k = starts[a] if point.size else 0
        if known[a]:
            first, last = old_starts[a], old_starts[a + 1]
            if point.size:
                for i in range(first, last):
                    point[k], share[k] = old_point[i], old_share[i]
                    k += 1
            else:
                starts[a + 1] = last - first
            continue
        per_length, per_room = 1.0 / length[a], 1.0 / room[a]
        mid_x = centre[a, 0] + 0.5 * length[a] * direction[a, 0]
        mid_y = centre[a, 1] + 0.5 * length[a] * direction[a, 1]
        left = max(int(np.floor((mid_x - reach - origin[0]) / size)), 0)
        right = min(int(np.floor((mid_x + reach - origin[0]) / size)), cells.shape[0] - 1)
        low = max(int(np.floor((mid_y - reach - origin[1]) / size)), 0)
        high = min(int(np.floor((mid_y + reach - origin[1]) / size)), cells.shape[1] - 2)
        for column in range(left, right + 1):
            if low > high:
                break
            for place in range(cells[column, low], cells[column, high + 1]):
                x, y = points[place, 0] - mid_x, points[place, 1] - mid_y
                if x * x + y * y > reach * reach:
                    continue
                if point.size:
                    x, y = points[place, 0] - centre[a, 0], points[place, 1] - centre[a, 1]
                    along = x * direction[a, 0] + y * direction[a, 1]
                    aside = y * direction[a, 0] - x * direction[a, 1]
                    part, ahead = min(max(along * per_length, 0.0), 1.0), max(along - length[a], 0.0)
                    share_of_arm = np.exp(
                        CREASE_ROUNDING
                        - np.sqrt(CREASE_ROUNDING**2 + (aside * per_beside) ** 2 + (ahead * per_beyond) ** 2)
                    )
                    share_of_arm *= max(1.0 - np.sqrt(aside * aside + ahead * ahead) * per_room, 0.0) * to_pin[place]
                    point[k], share[k] = order[place], part * share_of_arm
                k += 1
        if not point.size:
            starts[a + 1] = k
