"""Patches of six vertices for the plate, and the quadratic through their heights.

The quadratics that vanish at the three vertices of a triangle are spanned by the products `l1 l2, l2 l0, l0 l1` of its
barycentric coordinates. The heights of three more vertices above the triangle's plane therefore give the second
derivatives, by the inverse of the 3 x 3 matrix of these products at the three vertices. Every quadratic is exact.

The three vertices are the apexes of the adjacent triangles (Flores and Onate 2005). At the border an apex is missing,
and where all six vertices lie close to a conic the inverse is large. There the three are chosen among the vertices
nearby: the choice with the least sum of squared second derivatives for unit heights.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from asterism.discrete.energies.bending.hinges import interior_edges
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import triangle_areas, triangle_gradients

# 1: squared second derivatives for unit heights times squared area, once an affine map has made the triangle
# equilateral; affine images of equilateral meshes have 1, so that thin triangles beside arms keep their neighbours
MAX_CURVATURE_GAIN = 10.0
# 1: determinant of the products at the three vertices; below it the six vertices lie on a conic
MIN_DETERMINANT = 1e-9
_NONE = np.empty((0, 3), dtype=np.int64)


@dataclass(frozen=True)
class Patches:
    """One patch of six vertices for each triangle."""

    vertices: Array  # (T, 6) the three vertices of the triangle, then the three extra ones
    first: Array  # (T, 3, 2) 1/mm, gradients of the barycentric coordinates
    # (T, 3, 3) 1/mm^2, second derivatives 11, 12, 22 of the quadratic by the heights of the extra vertices above the
    # triangle.
    second: Array
    area: Array  # (T,) mm^2


def patches(triangles: Array, points: Array, surrounding: Array | None = None) -> Patches:
    """Patches of the triangles of a mesh.

    Parameters
    ----------
    triangles : (T, 3) vertices, counterclockwise.
    points : (V, 2) mm.
    surrounding : (R, 3) more triangles, whose vertices may serve as extra vertices; they get no patch.

    Raises
    ------
    MeshError
        A triangle has fewer than three more vertices around it that do not lie on a conic with its own.

    Examples
    --------
    On an equilateral triangle in the middle of a larger one the extra vertices are the three corners. The quadratic
    `x^2 - 2 x + y/h` is 0 at the corners of the small one, and its second derivatives are 2, 0 and 0:

    >>> h = 3.0**0.5
    >>> points = np.array([[0, 0], [2, 0], [1, h], [3, h], [-1, h], [1, -h]])
    >>> triangles = np.array([[0, 1, 2], [1, 3, 2], [2, 4, 0], [0, 5, 1]])
    >>> patch = patches(triangles[:1], points, triangles[1:])
    >>> patch.vertices[0].tolist()
    [0, 1, 2, 3, 4, 5]
    >>> x, y = points[patch.vertices[0, 3:]].T
    >>> ((x**2 - 2.0 * x + y / h) @ patch.second[0]).round(6) + 0.0
    array([2., 0., 0.])
    """
    all_triangles = triangles if surrounding is None else np.concatenate([triangles, surrounding])
    first, area = triangle_gradients(points, triangles), triangle_areas(points, triangles)
    products = _products(first)
    extra = _apexes(all_triangles)[: len(triangles)]
    second, gain = _second_derivatives(points, triangles, first, products, np.where(extra < 0, 0, extra))
    gain[(extra < 0).any(axis=1)] = np.inf
    neighbours = _vertex_neighbours(all_triangles)
    pending = {t: _candidates(triangles[t], extra[t], neighbours) for t in np.flatnonzero(~(gain < MAX_CURVATURE_GAIN))}
    while pending:
        tried = [next(choices, _NONE) for choices in pending.values()]
        if any(choices is _NONE for choices in tried):
            raise MeshError("the plate needs six vertices around every triangle: mesh.edge_mm must be smaller")
        owner, candidates = np.repeat(list(pending), [len(each) for each in tried]), np.concatenate(tried)
        derivatives, gains = _second_derivatives(points, triangles[owner], first[owner], products[owner], candidates)
        # the best of each triangle; where all are on conics, it tries its next candidates
        order = np.lexsort((gains.round(9), owner))  # rounding does not decide between mirror images
        best = order[np.unique(owner[order], return_index=True)[1]]
        best = best[np.isfinite(gains[best])]
        extra[owner[best]], second[owner[best]] = candidates[best], derivatives[best]
        settled = set(owner[best].tolist())
        pending = {t: choices for t, choices in pending.items() if t not in settled}
    return Patches(np.column_stack([triangles, extra]), first, second, area)


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


def _barycentric(points: Array, triangles: Array, first: Array, extra: Array) -> Array:
    """(T, 3, 3) barycentric coordinates (last axis) of the three extra vertices."""
    step = points[extra] - points[triangles[:, :1]]
    return np.asarray(np.einsum("tjk,tqk->tqj", first, step) + np.array([1.0, 0.0, 0.0]))


def _second_derivatives(
    points: Array, triangles: Array, first: Array, products: Array, extra: Array
) -> tuple[Array, Array]:
    """Second derivatives (T, 3, 3) for unit heights of the extra vertices, and gain (T,); infinite on a conic."""
    weight = _barycentric(points, triangles, first, extra)
    value = np.roll(weight, -1, axis=2) * np.roll(weight, -2, axis=2)
    # the inverse by cofactors, which for many small matrices is faster than a library's
    cofactors = np.cross(np.roll(value, -1, axis=1), np.roll(value, -2, axis=1))
    determinant = (value[:, 0] * cofactors[:, 0]).sum(axis=1)
    regular = np.abs(determinant) > MIN_DETERMINANT
    second = cofactors @ products / np.where(regular, determinant, 1.0)[:, None, None]
    # second derivatives along the three sides
    side = np.roll(points[triangles], -1, axis=1) - points[triangles]
    square = np.stack([side[..., 0] ** 2, 2.0 * side[..., 0] * side[..., 1], side[..., 1] ** 2], axis=-1)
    along = np.einsum("tqa,tja->tqj", second, square)
    gain = ((along**2).sum(axis=2) / 4.0 - along.sum(axis=2) ** 2 / 24.0).sum(axis=1)
    gain[~regular] = np.inf
    return second, gain


def _apexes(triangles: Array) -> Array:
    """(T, 3) apex of the adjacent triangle across the side opposite to each vertex; -1 at the border."""
    size = int(triangles.max()) + 1
    start, end = np.roll(triangles, -1, axis=1), np.roll(triangles, -2, axis=1)
    key = (start.astype(np.int64) * size + end).ravel()
    order = np.argsort(key)
    hinges = interior_edges(triangles).astype(np.int64)
    apexes = np.full(triangles.size, -1, dtype=np.int64)
    # the triangle whose side runs from `tail` to `head` is adjacent to the triangle with this apex
    for tail, head, apex in ((0, 1, 3), (1, 0, 2)):
        side = order[np.searchsorted(key[order], hinges[:, tail] * size + hinges[:, head])]
        apexes[side] = hinges[:, apex]
    out = apexes.reshape(triangles.shape)
    # around a vertex of three triangles, two sides have the same apex
    out[:, 1:][out[:, 1:] == out[:, :1]] = -1
    out[out[:, 2] == out[:, 1], 2] = -1
    return out


def _vertex_neighbours(triangles: Array) -> list[set[int]]:
    """Vertices that share a triangle with each vertex."""
    neighbours: list[set[int]] = [set() for _ in range(int(triangles.max()) + 1)]
    for a, b, c in triangles.tolist():
        neighbours[a] |= {b, c}
        neighbours[b] |= {c, a}
        neighbours[c] |= {a, b}
    return neighbours


def _candidates(triangle: Array, apexes: Array, neighbours: list[set[int]]) -> Iterator[Array]:
    """Candidates (n, 3) for the three extra vertices, in the order in which they are tried.

    At the border the existing apexes are kept if possible. Near a conic all three vertices are chosen anew.
    """
    own = set(triangle.tolist())
    nearby = set().union(*(neighbours[v] for v in own)) - own
    # corners of the sheet have few vertices nearby
    while len(nearby) < 4 and not set().union(*(neighbours[v] for v in nearby)) <= nearby | own:
        nearby |= set().union(*(neighbours[v] for v in nearby)) - own
    existing = {int(v) for v in apexes if v >= 0}
    choices = [existing, set()] if len(existing) < 3 else [set()]
    for kept in choices:
        more = combinations(sorted(nearby - kept), 3 - len(kept))
        yield np.array([[*sorted(kept), *some] for some in more], dtype=np.int64).reshape(-1, 3)
