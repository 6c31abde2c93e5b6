"""Does a sheet pass through itself?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from pattern.geometry.arrays import Floats, Ints

_SLIVER = 1e-12  # of a triangle's size: what only touches does not count
_APART = 3.0  # edges in print: places further apart were not neighbours


def self_intersections(positions: Floats, triangles: Ints) -> int:
    """Number of pairs of triangles that pass through each other; those that share a vertex are not asked.

    Parameters
    ----------
    positions : (V, 3) mm.
    triangles : (T, 3).
    """
    pairs = _close_pairs(positions, triangles)
    corner = positions[triangles]
    through = _edge_through(corner[pairs[:, 0]], corner[pairs[:, 1]])
    rest = ~through
    through[rest] = _edge_through(corner[pairs[rest, 1]], corner[pairs[rest, 0]])
    return int(through.sum())


def meets_itself(printed: Floats, positions: Floats, triangles: Ints) -> bool:
    """Whether places that were printed apart are close enough in space for their triangles to pass through each other.

    A fifth of the time of `self_intersections`, which finds nothing where this is false, but for folds within three
    edges: smooth sheets have none.

    Parameters
    ----------
    printed : (V, 2) mm.
    positions : (V, 3) mm.
    triangles : (T, 3).
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    longest = _lengths(positions, edges).max()
    # no point of a triangle is further from its nearest corner than this times its longest edge
    reach = 2.0 * longest / np.sqrt(3.0)
    near = cKDTree(positions).query_pairs(reach, output_type="ndarray")
    return bool((_lengths(printed, near) > _APART * _lengths(printed, edges).max()).any())


def passing(pairs: int, sheet: str = "the sheet") -> str:
    """What a number of such pairs means, in words."""
    return f"{sheet} passes through itself ({pairs} pairs of triangles)"


def _lengths(points: Floats, pairs: Ints) -> Floats:
    return np.asarray(np.linalg.norm(points[pairs[:, 0]] - points[pairs[:, 1]], axis=1))


def _close_pairs(positions: Floats, triangles: Ints) -> Ints:
    """(P, 2) pairs of triangles whose boxes overlap, without neighbours."""
    corner = positions[triangles]
    low, high = corner.min(axis=1), corner.max(axis=1)
    middle = 0.5 * (low + high)
    reach = float((high - low).max())  # boxes that overlap have middles closer than this in every direction
    pairs = cKDTree(middle).query_pairs(reach, p=np.inf, output_type="ndarray")
    i, j = pairs.T
    boxes = (low[i] <= high[j]).all(axis=1) & (low[j] <= high[i]).all(axis=1)
    pairs = pairs[boxes]
    first, second = triangles[pairs[:, 0]], triangles[pairs[:, 1]]
    # corner by corner: an array of all nine comparisons would be the largest of this file
    shared = np.zeros(len(pairs), dtype=bool)
    for a in range(3):
        for b in range(3):
            shared |= first[:, a] == second[:, b]
    return np.asarray(pairs[~shared])


def _edge_through(first: Floats, second: Floats) -> NDArray[np.bool_]:
    """(P,) an edge of the first triangle (P, 3, 3) passes through the second one."""
    a, b, c = second.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    height = np.einsum("pki,pi->pk", first - a[:, None], normal)
    out = np.zeros(len(first), dtype=bool)
    for start, end in ((0, 1), (1, 2), (2, 0)):
        h0, h1 = height[:, start], height[:, end]
        crosses = np.flatnonzero(h0 * h1 < 0.0)
        t = h0[crosses] / (h0[crosses] - h1[crosses])
        p, q = first[crosses, start], first[crosses, end]
        point = p + t[:, None] * (q - p)
        n = normal[crosses]
        inside = np.ones(len(crosses), dtype=bool)
        for u, v in ((a, b), (b, c), (c, a)):
            side = (np.cross(v[crosses] - u[crosses], point - u[crosses]) * n).sum(axis=1)
            inside &= side > _SLIVER * (n * n).sum(axis=1)
        out[crosses[inside]] = True
    return out
