"""The outline of a sheet with as few points as a coarse mesh needs, and the same area.

Corners and the ends of supported edges keep their places. Between them, a line of many short edges becomes a line of
few longer ones. It moves outwards or inwards until the area of the sheet is restored.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.planar import polygon_area, turning_angles

# an outline that turns by more has a corner there
OUTLINE_CORNER_DEG = 35.0
# largest distance of the simplified line from the outline, before it is moved, in mesh edges
OUTLINE_DEVIATION_EDGES = 0.06


@dataclass(frozen=True)
class CoarseOutline:
    """A ring of points and, for each side to the next point, the side of the outline where it begins.

    Attributes
    ----------
    points : (n, 2) mm, counterclockwise.
    side : (n,) the first of the outline's sides that a coarse side stands for.
    """

    points: Floats
    side: Ints


def coarse_outline(border: Floats, edge_mm: float, fixed: Ints) -> CoarseOutline:
    """A simpler ring.

    Parameters
    ----------
    border : (B, 2) mm, simple polygon.
    edge_mm : what counts as short.
    fixed : corners that must stay.
    """
    kept = np.union1d(fixed, np.flatnonzero(np.abs(turning_angles(border)) > np.radians(OUTLINE_CORNER_DEG))).astype(
        np.int64
    )
    whole = np.arange(len(border))
    if len(kept) == len(border):
        return CoarseOutline(border, whole)
    # without corners the ring begins anywhere, and that point moves with the others
    starts = kept if len(kept) else np.array([0])
    points, sides, loose = [], [], []
    for start, end in zip(starts, np.roll(starts, -1), strict=True):
        count = (end - start) % len(border) or len(border)
        numbers = (start + np.arange(count + 1)) % len(border)
        chosen = _simplified(border[numbers], OUTLINE_DEVIATION_EDGES * edge_mm)
        points.append(border[numbers[chosen[:-1]]])
        sides.append(numbers[chosen[:-1]])
        moves = np.full(len(chosen) - 1, len(chosen) <= count)
        moves[0] = len(kept) == 0
        loose.append(moves)
    ring, moving = np.concatenate(points), np.concatenate(loose)
    ring = _same_area(ring, moving, polygon_area(border))
    if len(ring) < 3 or not shapely.is_valid(shapely.polygons(ring)):
        return CoarseOutline(border, whole)
    return CoarseOutline(ring, np.concatenate(sides))


def _simplified(line: Floats, tolerance: float) -> Ints:
    """Numbers of the points of a line that stay: the ends, and evenly spread ones as near to it as asked for."""
    length = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))]
    closed = np.allclose(line[0], line[-1])
    for pieces in range(6 if closed else 1, len(line) - 1):
        even = np.searchsorted(length, np.linspace(0.0, length[-1], pieces + 1)[1:-1] - 1e-9 * length[-1])
        chosen = np.unique(np.r_[0, even, len(line) - 1])
        gap = shapely.hausdorff_distance(shapely.linestrings(line[chosen]), shapely.linestrings(line))
        # a line with one piece has no point that could give the area back
        if gap <= tolerance and (len(chosen) > 2 or gap <= 1e-9 * length[-1]):
            return chosen
    return np.arange(len(line))


def _same_area(ring: Floats, moving: np.ndarray, area: float) -> Floats:
    """The ring with its moving points shifted along their normals, all by the same length."""
    if not moving.any():
        return ring
    tangent = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]]) / np.linalg.norm(tangent, axis=1, keepdims=True)
    normal[~moving] = 0.0
    for _ in range(4):  # the area is a quadratic function of the shift: Newton's method
        rate = 0.5 * (normal * np.column_stack([tangent[:, 1], -tangent[:, 0]])).sum()
        ring = ring + (area - polygon_area(ring)) / rate * normal
        tangent = np.roll(ring, -1, axis=0) - np.roll(ring, 1, axis=0)
    return ring
