"""Which of many points and segments in the plane come near each other, found on a grid of square cells."""

from __future__ import annotations

import numpy as np

from pattern.layout import Floats, Ints
from pattern.planar import cross

FINEST = 64  # cells along the longer side


def near_segments(points: Floats, segments: Ints, tolerance: float) -> tuple[Ints, Ints]:
    """Segments and points (k,) each, for all pairs where a point that is not an end lies in a segment's box.

    `segments`: (m, 2) numbers of points (n, 2); `tolerance`: by how much the boxes are larger on all sides.
    """
    low, high = _boxes(points, segments, tolerance)
    segment, cell, of_point = _cells(points, low, high)
    order = np.argsort(of_point)
    first, last = (np.searchsorted(of_point[order], cell, side) for side in ("left", "right"))
    pair, number = _expanded(last - first)
    segment, point = segment[pair], order[first[pair] + number]
    at = points[point]
    inside = ((at >= low[segment]) & (at <= high[segment]) & (segments[segment] != point[:, None])).all(axis=1)
    return segment[inside], point[inside]


def crossings(points: Floats, segments: Ints) -> Ints:
    """(k, 2) pairs of segments without a common end that cross, the first ones first; no point is on a segment."""
    segment, cell, _ = _cells(points, *_boxes(points, segments, 0.0))
    order = np.argsort(cell)
    segment, cell = segment[order], cell[order]
    pairs, ahead = [np.empty((0, 2), dtype=np.int64)], 1
    while (same := cell[ahead:] == cell[:-ahead]).any():
        pairs.append(np.column_stack([segment[:-ahead][same], segment[ahead:][same]]))
        ahead += 1
    one, two = np.concatenate(pairs).T
    (a, b), (c, d) = segments[one].T, segments[two].T
    apart = (a != c) & (a != d) & (b != c) & (b != d)
    one, two, (a, b, c, d) = one[apart], two[apart], points[np.array([a, b, c, d])[:, apart]]
    through = cross(b - a, c - a) * cross(b - a, d - a) < 0.0
    through &= cross(d - c, a - c) * cross(d - c, b - c) < 0.0
    return np.unique(np.sort(np.column_stack([one, two])[through], axis=1), axis=0)


def _boxes(points: Floats, segments: Ints, tolerance: float) -> tuple[Floats, Floats]:
    ends = points[segments]
    return ends.min(axis=1) - tolerance, ends.max(axis=1) + tolerance


def _cells(points: Floats, low: Floats, high: Floats) -> tuple[Ints, Ints, Ints]:
    """Box and cell (k,) each, for all cells that boxes reach into, and the cells (n,) of the points."""
    origin = np.minimum(low.min(axis=0), points.min(axis=0))
    # boxes of about one cell reach into few of them
    size = max(float((high - low).max(axis=1).mean()), float(np.ptp(points, axis=0).max()) / FINEST)
    first, last, own = (np.floor((at - origin) / size).astype(np.int64) for at in (low, high, points))
    columns = int(max(last[:, 1].max(), own[:, 1].max())) + 1
    width, height = (last - first + 1).T
    box, number = _expanded(width * height)
    i, j = np.divmod(number, height[box])
    return box, (first[box, 0] + i) * columns + first[box, 1] + j, own[:, 0] * columns + own[:, 1]


def _expanded(count: Ints) -> tuple[Ints, Ints]:
    """Row and number 0 ... n - 1 within it, of rows with `count` n entries each."""
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - (np.cumsum(count) - count)[row]
