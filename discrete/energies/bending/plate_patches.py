"""The six vertices around each triangle, and the quadratic through them.

Quadratics that vanish at the triangle's own vertices are spanned by the products `l1 l2, l2 l0, l0 l1` of its
barycentric coordinates. What three more vertices have above the plane of the triangle therefore gives the second
derivatives, by the inverse of the 3 x 3 matrix of those products at the three. The three are the apexes of the
neighbours. Where one is missing (border), or where all six lie close to a conic and the inverse is large, they are
chosen among all vertices around: the three with the least sum of squared second derivatives for unit heights.
Quadratics stay exact everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from discrete.energies.bending.hinges import interior_edges
from discrete.energies.elements import Array
from pattern.design.errors import MeshError
from pattern.geometry.planar import triangle_areas, triangle_gradients

# of the second derivatives for unit heights, squared, times the area squared; equilateral triangles have 1
MAX_CURVATURE_GAIN = 4.0


@dataclass(frozen=True)
class Patches:
    """One patch of six vertices for each triangle.

    Attributes
    ----------
    vertices : (T, 6) the triangle's own three, then the others.
    first : (T, 3, 2) 1/mm, gradients of the barycentric coordinates.
    second : (T, 6, 3) 1/mm^2, second derivatives 11, 12, 22 of the quadratic for the height of each vertex.
    area : (T,) mm^2.
    """

    vertices: Array
    first: Array
    second: Array
    area: Array


def patches(triangles: Array, points: Array, around: Array | None = None) -> Patches:
    """Patches of counterclockwise triangles (T, 3) on points (V, 2); more triangles (R, 3) may lie around them."""
    every = triangles if around is None else np.concatenate([triangles, around])
    first, area = triangle_gradients(points, triangles), triangle_areas(points, triangles)
    products = _products(first)
    others = _apexes(every)[: len(triangles)]
    second, gain = _second(points, triangles, first, products, area, np.where(others < 0, 0, others))
    gain[(others < 0).any(axis=1)] = np.inf
    near = _around(every)
    for t in np.flatnonzero(~(gain < MAX_CURVATURE_GAIN)):
        for trios in _trios(triangles[t], others[t], near):
            one = np.full(len(trios), t)
            choice, gains = _second(points, triangles[one], first[one], products[one], area[one], trios)
            if len(trios) and np.isfinite(gains).any():
                best = int(np.argmin(gains))
                others[t], second[t] = trios[best], choice[best]
                break
        else:
            raise MeshError("consistent bending needs six vertices around every triangle: mesh.edge_mm must be smaller")
    # a height is measured from the triangle's own plane
    own = -np.einsum("tqa,tqj->tja", second, _barycentric(points, triangles, first, others))
    return Patches(np.column_stack([triangles, others]), first, np.concatenate([own, second], axis=1), area)


def _products(first: Array) -> Array:
    """(T, 3, 3) second derivatives 11, 12, 22 of l1 l2, l2 l0 and l0 l1."""
    a, b = np.roll(first, -1, axis=1), np.roll(first, -2, axis=1)
    return np.stack(
        [
            2.0 * a[..., 0] * b[..., 0],
            a[..., 0] * b[..., 1] + a[..., 1] * b[..., 0],
            2.0 * a[..., 1] * b[..., 1],
        ],
        axis=-1,
    )


def _barycentric(points: Array, triangles: Array, first: Array, others: Array) -> Array:
    """(T, 3, 3) barycentric coordinates (last axis) of the other three vertices."""
    step = points[others] - points[triangles[:, :1]]
    return np.asarray(np.einsum("tjk,tqk->tqj", first, step) + np.array([1.0, 0.0, 0.0]))


def _second(
    points: Array, triangles: Array, first: Array, products: Array, area: Array, others: Array
) -> tuple[Array, Array]:
    """Second derivatives (T, 3, 3) for unit heights of the others, and the gain (T,); infinite on a conic."""
    weight = _barycentric(points, triangles, first, others)
    value = np.roll(weight, -1, axis=2) * np.roll(weight, -2, axis=2)
    possible = np.abs(np.linalg.det(value)) > 1e-9
    value[~possible] = np.eye(3)
    second = np.einsum("tpq,tpa->tqa", np.linalg.inv(value), products)
    gain = (second**2 @ np.array([1.0, 2.0, 1.0])).sum(axis=1) * area**2
    gain[~possible] = np.inf
    return second, gain


def _apexes(triangles: Array) -> Array:
    """(T, 3) the neighbour's vertex across the side opposite to each vertex, -1 beyond the border."""
    size = int(triangles.max()) + 1
    start, end = np.roll(triangles, -1, axis=1), np.roll(triangles, -2, axis=1)
    key = (start.astype(np.int64) * size + end).ravel()
    order = np.argsort(key)
    hinges = interior_edges(triangles).astype(np.int64)
    sides = np.full(triangles.size, -1, dtype=np.int64)
    # the apex on the left is in the triangle that runs along the edge as it is given
    for one, other, apex in ((0, 1, 3), (1, 0, 2)):
        side = order[np.searchsorted(key[order], hinges[:, one] * size + hinges[:, other])]
        sides[side] = hinges[:, apex]
    out = sides.reshape(triangles.shape)
    # around a vertex of three triangles two sides share an apex
    out[:, 1:][out[:, 1:] == out[:, :1]] = -1
    out[out[:, 2] == out[:, 1], 2] = -1
    return out


def _around(triangles: Array) -> list[set[int]]:
    """The neighbours of every vertex."""
    around: list[set[int]] = [set() for _ in range(int(triangles.max()) + 1)]
    for a, b, c in triangles.tolist():
        around[a] |= {b, c}
        around[b] |= {c, a}
        around[c] |= {a, b}
    return around


def _trios(own: Array, apexes: Array, around: list[set[int]]) -> list[Array]:
    """Candidates (n, 3) for the other three vertices, in the order in which they are tried.

    At the border the apexes that exist are kept if that is possible; six vertices near a conic are all chosen anew.
    """
    mine = set(own.tolist())
    near = set().union(*(around[v] for v in mine)) - mine
    # corners of the sheet have few vertices around
    while len(near) < 4 and not set().union(*(around[v] for v in near)) <= near | mine:
        near |= set().union(*(around[v] for v in near)) - mine
    existing = {int(v) for v in apexes if v >= 0}
    choices = [existing, set()] if len(existing) < 3 else [set()]
    out = []
    for kept in choices:
        more = combinations(sorted(near - kept), 3 - len(kept))
        out.append(np.array([[*sorted(kept), *some] for some in more], dtype=np.int64).reshape(-1, 3))
    return out
