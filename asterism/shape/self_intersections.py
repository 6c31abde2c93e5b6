"""Self-intersections of a triangulated sheet."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.shape.surface_fields import directed_edges


def self_intersections(positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]) -> int:
    """Count the pairs of triangles (T, 3) at positions (V, 3) mm that pass through each other and share no vertex."""
    pairs = _close_pairs(positions, triangles)
    corner = positions[triangles]
    through = _edge_through(corner[pairs[:, 0]], corner[pairs[:, 1]])
    rest = ~through
    through[rest] = _edge_through(corner[pairs[rest, 1]], corner[pairs[rest, 0]])
    return int(through.sum())


def meets_itself(
    printed: Float[np.ndarray, "V 2"], positions: Float[np.ndarray, "V 3"], triangles: Int[np.ndarray, "T 3"]
) -> bool:
    """Fast test whether a smooth sheet, printed (V, 2) mm and at positions (V, 3) mm, may pass through itself.

    True if two vertices that are printed more than three edge lengths apart are so close in space that their triangles
    can touch. If this is false, `self_intersections` can only find folds within three edge lengths, which a smooth
    sheet does not have. The test takes a fifth of its time.
    """
    edges = directed_edges(triangles)
    longest = _lengths(positions, edges).max()
    # each point of a triangle is within (longest edge) / sqrt(3) of its nearest corner
    reach = 2.0 * longest / np.sqrt(3.0)
    near = cKDTree(positions).query_pairs(reach, output_type="ndarray")
    # two vertices whose printed distance is above this number of edge lengths are not neighbours
    return bool((_lengths(printed, near) > 3.0 * _lengths(printed, edges).max()).any())


def _lengths(points: Floats, pairs: Ints) -> Floats:
    apart = points[pairs[:, 0]] - points[pairs[:, 1]]
    return np.asarray(np.sqrt(np.einsum("pi,pi->p", apart, apart)))  # faster than numpy's norm


def _close_pairs(positions: Floats, triangles: Ints) -> Ints:
    """(P, 2) pairs of triangles whose bounding boxes overlap, without pairs that share a vertex."""
    corner = positions[triangles]
    low, high = corner.min(axis=1), corner.max(axis=1)
    middle = 0.5 * (low + high)
    reach = float((high - low).max())  # the centres of overlapping boxes are closer than this along x, y and z
    pairs = cKDTree(middle).query_pairs(reach, p=np.inf, output_type="ndarray")
    i, j = pairs.T
    boxes = (low[i] <= high[j]).all(axis=1) & (low[j] <= high[i]).all(axis=1)
    pairs = pairs[boxes]
    first, second = triangles[pairs[:, 0]], triangles[pairs[:, 1]]
    # one pair of corners at a time: an array of all nine comparisons would need the most memory of this file
    shared = np.zeros(len(pairs), dtype=bool)
    for a in range(3):
        for b in range(3):
            shared |= first[:, a] == second[:, b]
    return np.asarray(pairs[~shared])


def _edge_through(first: Floats, second: Floats) -> NDArray[np.bool_]:
    """(P,) whether an edge of the first triangle (P, 3, 3) passes through the second one."""
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
            # triangles that overlap by less than this part of their size only touch
            inside &= side > 1e-12 * (n * n).sum(axis=1)
        out[crosses[inside]] = True
    return out
