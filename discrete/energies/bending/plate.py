"""Plate bending of the fabric: constant curvature on patches of six vertices, with displacements as only unknowns.

With the rest area A of the triangle, the energy of a patch is

    W = A/2 [D11 k11^2 + 2 D12 k11 k22 + D22 k22^2 + 4 D66 k12^2].

The three vertices of the triangle and three more (the apexes of the adjacent triangles) define one quadratic surface,
as in the enhanced basic shell triangle of Flores and Onate (2005). The tangents of the flat triangle are `F = Q R` with
R upper triangular, and its normal is n. The curvature is `k = R^-T b R^-1` with `b_ab = n . x_ab`. This is `C^-1 b` in
the orthonormal frame whose e1 lies along the first axis of the fabric, and e2 across it in the surface.

Measure of curvature. The fabric is stretched by a third along the arms, so the measure matters. Integration of the
membrane law through a constant thickness gives `C^-1 b`: the tangent stiffness is contracted with C^-1. With b on the
rest metric, a sheet stretched by 1.35 would be 3.3 times stiffer, and a compressed sheet would hardly resist bending.

Derivatives, in that frame. A vertex moves by u; t is the surface gradient and B the second covariant derivative of its
shape function. Motion along n changes b, motion in the surface changes R. With `L = u t`, the change of R is the upper
triangle L11, L12 + L21, L22, so that

    dk11 = B11 (n . u) - 2 k11 L11,
    dk12 = B12 (n . u) - k12 (L11 + L22) - k11 (L12 + L21),
    dk22 = B22 (n . u) - 2 k22 L22 - 2 k12 (L12 + L21).

With the moments `m = dW/dk`, the first variation is `m . dk`, and the second `dm . dk`, which is never negative, plus
`m . d2k`. The second order of k follows from `x = L11 + L21^2/2`, `y = L12 + L21 + L21 (L22 - L11)` and
`z = L22 - L21 L12 - L21^2/2`, by which R11, R12 and R22 change, and from the rotation of the normal.

Patches. The quadratics that vanish at the three vertices of a triangle are spanned by the products `l1 l2, l2 l0,
l0 l1` of its barycentric coordinates. The heights of three more vertices above the triangle's plane therefore give the
second derivatives, by the inverse of the 3 x 3 matrix of these products at the three vertices. Every quadratic is
exact. At the border an apex is missing, and where all six vertices lie close to a conic the inverse is large. There the
three are chosen among the vertices nearby: the choice with the least sum of squared second derivatives for unit
heights.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import cast

import numpy as np

from asterism.discrete.energies.bending.fabric_bending import (
    FABRIC_BENDING,
    BendingMesh,
    FabricBending,
    interior_edges,
)
from asterism.discrete.energies.bending.hinges import Hinges, fold_coefficients
from asterism.discrete.energies.elements import Elements
from asterism.discrete.energies.kernel import combine, cross, dot, formula, multiply, point, sub, sweep
from asterism.equilibrium.arrays import Array
from asterism.pattern.design.errors import MeshError
from asterism.pattern.design.materials import BendingStiffness
from asterism.pattern.geometry.planar import triangle_areas, triangle_gradients

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

    Raises `MeshError` if a triangle has fewer than three more vertices around it that do not lie on a conic with its
    own.

    Parameters
    ----------
    triangles : (T, 3) vertices, counterclockwise.
    points : (V, 2) mm.
    surrounding : (R, 3) more triangles, whose vertices may serve as extra vertices; they get no patch.

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
    second, gain = _quadratic(points, triangles, first, products, np.where(extra < 0, 0, extra))
    gain[(extra < 0).any(axis=1)] = np.inf
    neighbours = _vertex_neighbours(all_triangles)
    # squared second derivatives for unit heights times squared area, once an affine map has made the triangle
    # equilateral; affine images of equilateral meshes have 1, so that thin triangles beside arms keep their neighbours
    pending = {t: _candidates(triangles[t], extra[t], neighbours) for t in np.flatnonzero(~(gain < 10.0))}
    while pending:
        tried = [next(choices, _NONE) for choices in pending.values()]
        if any(choices is _NONE for choices in tried):
            raise MeshError("the plate needs six vertices around every triangle: mesh.edge_mm must be smaller")
        owner, candidates = np.repeat(list(pending), [len(each) for each in tried]), np.concatenate(tried)
        derivatives, gains = _quadratic(points, triangles[owner], first[owner], products[owner], candidates)
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


def _quadratic(points: Array, triangles: Array, first: Array, products: Array, extra: Array) -> tuple[Array, Array]:
    """Second derivatives (T, 3, 3) for unit heights of the extra vertices, and gain (T,); infinite on a conic."""
    # barycentric coordinates (T, 3, 3) of the extra vertices, the last axis
    step = points[extra] - points[triangles[:, :1]]
    weight = np.einsum("tjk,tqk->tqj", first, step) + np.array([1.0, 0.0, 0.0])
    value = np.roll(weight, -1, axis=2) * np.roll(weight, -2, axis=2)
    # the inverse by cofactors, which for many small matrices is faster than a library's
    cofactors = np.cross(np.roll(value, -1, axis=1), np.roll(value, -2, axis=1))
    determinant = (value[:, 0] * cofactors[:, 0]).sum(axis=1)
    # determinant of the products at the three vertices; below it the six vertices lie on a conic
    regular = np.abs(determinant) > 1e-9
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


@formula
def _frame(q, p):  # type: ignore[no-untyped-def]
    """Orthonormal frame (e1, e2, n) of the flat triangle; 1/R11, R12/R11 and 1/R22."""
    x0 = point(q, 0)
    side1, side2 = sub(point(q, 1), x0), sub(point(q, 2), x0)
    f1, f2 = combine(p[4], side1, p[6], side2), combine(p[5], side1, p[7], side2)
    by_11 = 1.0 / np.sqrt(dot(f1, f1))
    e1 = multiply(by_11, f1)
    shear = by_11 * dot(e1, f2)
    across = combine(1.0, f2, -shear, f1)
    by_22 = 1.0 / np.sqrt(dot(across, across))
    e2 = multiply(by_22, across)
    return e1, e2, cross(e1, e2), (by_11, shear, by_22)


@formula
def _in_frame(s11, s12, s22, r):  # type: ignore[no-untyped-def]
    """`R^-T s R^-1` of a symmetric tensor s in printed coordinates."""
    by_11, shear, by_22 = r
    s12, s22 = s12 - shear * s11, s22 - shear * (2.0 * s12 - shear * s11)
    return by_11 * by_11 * s11, by_11 * by_22 * s12, by_22 * by_22 * s22


@formula
def _curvature(q, p, n, r):  # type: ignore[no-untyped-def]
    """Components 11, 12, 22 of k, from the heights of the three extra vertices above the triangle."""
    x0 = point(q, 0)
    z0, z1, z2 = dot(n, sub(point(q, 3), x0)), dot(n, sub(point(q, 4), x0)), dot(n, sub(point(q, 5), x0))
    return _in_frame(
        p[8] * z0 + p[11] * z1 + p[14] * z2,
        p[9] * z0 + p[12] * z1 + p[15] * z2,
        p[10] * z0 + p[13] * z1 + p[16] * z2,
        r,
    )


@formula
def _moment(p, k):  # type: ignore[no-untyped-def]
    """`dW/dk` for the components 11, 12, 22 of k."""
    return p[0] * k[0] + p[1] * k[2], 4.0 * p[3] * k[1], p[1] * k[0] + p[2] * k[2]


@formula
def _stress(m, k):  # type: ignore[no-untyped-def]
    """Symmetric tensor s, components 11, 12, 22, with `s . L = -m . dk` for motion in the surface."""
    return 2.0 * m[0] * k[0] + m[1] * k[1], m[1] * k[0] + 2.0 * m[2] * k[1], m[1] * k[1] + 2.0 * m[2] * k[2]


@formula
def _gradients(p, r):  # type: ignore[no-untyped-def]
    """Surface gradients of the shape functions of the triangle's vertices, in the frame."""
    a1, b1 = r[0] * p[4], r[2] * (p[5] - r[1] * p[4])
    a2, b2 = r[0] * p[6], r[2] * (p[7] - r[1] * p[6])
    return (-a1 - a2, -b1 - b2), (a1, b1), (a2, b2)


@formula
def _second_derivatives(q, p, e1, e2, r, t1, t2):  # type: ignore[no-untyped-def]
    """Second covariant derivatives 11, 12, 22 of the shape functions of the six vertices, in the frame.

    The height of an extra vertex above the triangle has the derivatives b. The heights of the triangle's own vertices
    are subtracted from it, by the barycentric coordinates of the extra vertex.
    """
    x0 = point(q, 0)
    own0 = own1 = own2 = (0.0, 0.0, 0.0)
    for i in range(3):
        b = _in_frame(p[8 + 3 * i], p[9 + 3 * i], p[10 + 3 * i], r)
        away = sub(point(q, 3 + i), x0)
        y1, y2 = dot(e1, away), dot(e2, away)
        l1, l2 = t1[0] * y1 + t1[1] * y2, t2[0] * y1 + t2[1] * y2
        own0, own1, own2 = combine(1.0, own0, l1 + l2 - 1.0, b), combine(1.0, own1, -l1, b), combine(1.0, own2, -l2, b)
    return own0, own1, own2


@formula
def plate_energy(q, p):  # type: ignore[no-untyped-def]
    """Energy of a patch in N mm.

    p = A (D11, D12, D22, D66), gradients of the second and third shape function (2 x 2), and second derivatives 11,
    12, 22 for the heights of the three extra vertices (3 x 3).
    """
    _, _, n, r = _frame(q, p)
    k = _curvature(q, p, n, r)
    return 0.5 * dot(_moment(p, k), k)


@formula
def plate_gradient(q, p, g):  # type: ignore[no-untyped-def]
    """`(m . B) n - s t` for every vertex."""
    e1, e2, n, r = _frame(q, p)
    k = _curvature(q, p, n, r)
    m = _moment(p, k)
    s11, s12, s22 = _stress(m, k)
    t0, t1, t2 = _gradients(p, r)
    b0, b1, b2 = _second_derivatives(q, p, e1, e2, r, t1, t2)
    for i, t, b in ((0, t0, b0), (1, t1, b1), (2, t2, b2)):
        lift, along1, along2 = dot(m, b), -(s11 * t[0] + s12 * t[1]), -(s12 * t[0] + s22 * t[1])
        for c in range(3):
            g[3 * i + c] = lift * n[c] + along1 * e1[c] + along2 * e2[c]
    for i in range(3):
        lift = dot(m, _in_frame(p[8 + 3 * i], p[9 + 3 * i], p[10 + 3 * i], r))
        for c in range(3):
            g[9 + 3 * i + c] = lift * n[c]


@formula
def plate_hessian(q, p, blend, h):  # type: ignore[no-untyped-def]
    """The quadratic form `dm . dk`, plus (1 - blend) times `m . d2k`.

    Motion a n of vertex i and motion v in the surface of vertex j have the mixed second variation a w . v with
    `w = Y_i t_j - (m . B_j) t_i`. The tensor -Y_i is the stress of the moments of B_i with the curvatures k, plus the
    stress of the moments m with the curvatures B_i. The second terms of w and of -Y_i belong to `m . d2k`.
    """
    e1, e2, n, r = _frame(q, p)
    k = _curvature(q, p, n, r)
    m = multiply(1.0 - blend, _moment(p, k))
    s11, s12, s22 = _stress(m, k)
    work = dot(m, k)
    # dk by L11, by L12 or L21, and by L22, and their moments
    k11, k12, k22 = k
    k_a, k_b, k_c = (-2.0 * k11, -k12, 0.0 * k11), (0.0 * k11, -k11, -2.0 * k12), (0.0 * k11, -k12, -2.0 * k22)
    m_a, m_b, m_c = _moment(p, k_a), _moment(p, k_b), _moment(p, k_c)
    # second derivatives of W by L: dm . dk, and m . d2k
    m11, m12, m22 = m
    l11_l11 = dot(m_a, k_a) + 6.0 * m11 * k11 + 2.0 * m12 * k12
    l11_l12 = dot(m_a, k_b) + 2.0 * (m12 * k11 + m22 * k12)
    l11_l21 = dot(m_a, k_b) + 3.0 * m12 * k11 + 4.0 * m22 * k12
    l11_l22 = dot(m_a, k_c) + m12 * k12
    l12_l12 = dot(m_b, k_b) + 2.0 * m22 * k11
    l12_l21 = dot(m_b, k_b) + 2.0 * m22 * (k11 + k22) + m12 * k12
    l12_l22 = dot(m_b, k_c) + m12 * k11 + 4.0 * m22 * k12
    l21_l21 = dot(m_b, k_b) + 2.0 * m22 * (k11 + k22) - 2.0 * m11 * k11
    l21_l22 = dot(m_b, k_c) + 2.0 * m22 * k12
    l22_l22 = dot(m_c, k_c) + 6.0 * m22 * k22 + 2.0 * m12 * k12
    # t, m . B, B and Y of the triangle's vertices, above the diagonal of h, where nobody reads
    t0, t1, t2 = _gradients(p, r)
    b0, b1, b2 = _second_derivatives(q, p, e1, e2, r, t1, t2)
    for i, t, b in ((0, t0, b0), (1, t1, b1), (2, t2, b2)):
        h[i, 9], h[i, 10] = t
        h[i, 11] = dot(m, b)
        h[i, 12], h[i, 13], h[i, 14] = b
        h[i, 15], h[i, 16], h[i, 17] = combine(-1.0, _stress(_moment(p, b), k), -1.0, _stress(m, b))
    for i in range(3):
        ti1, ti2, lift_i, yi11, yi12, yi22 = h[i, 9], h[i, 10], h[i, 11], h[i, 15], h[i, 16], h[i, 17]
        moment = _moment(p, (h[i, 12], h[i, 13], h[i, 14]))
        for j in range(i + 1):
            tj1, tj2, lift_j, yj11, yj12, yj22 = h[j, 9], h[j, 10], h[j, 11], h[j, 15], h[j, 16], h[j, 17]
            t11, t12, t21, t22 = ti1 * tj1, ti1 * tj2, ti2 * tj1, ti2 * tj2
            both = t12 + t21
            # block in the frame, first by motion of vertex i
            b11 = l11_l11 * t11 + l11_l12 * both + l12_l12 * t22
            b12 = l11_l21 * t11 + l11_l22 * t12 + l12_l21 * t21 + l12_l22 * t22
            b21 = l11_l21 * t11 + l11_l22 * t21 + l12_l21 * t12 + l12_l22 * t22
            b22 = l21_l21 * t11 + l21_l22 * both + l22_l22 * t22
            b1n, b2n = yj11 * ti1 + yj12 * ti2 - lift_i * tj1, yj12 * ti1 + yj22 * ti2 - lift_i * tj2
            bn1, bn2 = yi11 * tj1 + yi12 * tj2 - lift_j * ti1, yi12 * tj1 + yi22 * tj2 - lift_j * ti2
            bnn = dot(moment, (h[j, 12], h[j, 13], h[j, 14])) - s11 * t11 - s12 * both - s22 * t22 - work * (t11 + t22)
            row1 = combine(1.0, combine(b11, e1, b12, e2), b1n, n)
            row2 = combine(1.0, combine(b21, e1, b22, e2), b2n, n)
            rown = combine(1.0, combine(bn1, e1, bn2, e2), bnn, n)
            for a in range(3):
                for c in range(3):
                    h[3 * i + a, 3 * j + c] = e1[a] * row1[c] + e2[a] * row2[c] + n[a] * rown[c]
    for i in range(3, 6):
        b = _in_frame(p[3 * i - 1], p[3 * i], p[3 * i + 1], r)
        moment, lift = _moment(p, b), dot(m, b)
        y11, y12, y22 = combine(-1.0, _stress(moment, k), -1.0, _stress(m, b))
        for j in range(3):
            t1, t2 = h[j, 9], h[j, 10]
            column = combine(-lift * t1, e1, -lift * t2, e2)
            row = combine(y11 * t1 + y12 * t2, e1, y12 * t1 + y22 * t2, e2)
            row = combine(1.0, row, dot(moment, (h[j, 12], h[j, 13], h[j, 14])), n)
            for a in range(3):
                for c in range(3):
                    h[3 * i + a, 3 * j + c] = column[a] * n[c] + n[a] * row[c]
        for j in range(3, i + 1):
            row = multiply(dot(moment, _in_frame(p[3 * j - 1], p[3 * j], p[3 * j + 1], r)), n)
            for a in range(3):
                for c in range(3):
                    h[3 * i + a, 3 * j + c] = n[a] * row[c]


class Plate(Elements):
    """Plate bending of the fabric, one patch for each triangle.

    Raises `MeshError` if a triangle has too few vertices around it, see `patches`.

    Parameters
    ----------
    triangles : (T, 3) vertices, counterclockwise.
    printed : (V, 2) mm; any image of the rest shape with other scales of x and y gives the same curvatures.
    stiffness : along x (11) and y (22) of the print.
    surrounding : (R, 3) triangles next to these, whose vertices belong to patches; they have no energy.

    A paraboloid of curvature 0.001/mm has the energy `D (1 + nu) k^2` per area; here D = 8 N mm, A = sqrt(3) mm^2:

    >>> h = 3.0**0.5
    >>> points = np.array([[0, 0], [2, 0], [1, h], [3, h], [-1, h], [1, -h]])
    >>> triangles = np.array([[0, 1, 2], [1, 3, 2], [2, 4, 0], [0, 5, 1]])
    >>> plate = Plate(triangles[:1], points, BendingStiffness.orthotropic(8.0, 8.0, 0.0), surrounding=triangles[1:])
    >>> sheet = np.column_stack([points, 0.0005 * (points**2).sum(axis=1)])
    >>> round(float(plate.energies(sheet.ravel())[0] / (8.0 * h * 0.001**2)), 3)
    1.0
    """

    formulas = (plate_energy, plate_gradient, plate_hessian)
    sweep = staticmethod(sweep(18, 18, *formulas))

    def __init__(
        self, triangles: Array, printed: Array, stiffness: BendingStiffness, surrounding: Array | None = None
    ) -> None:
        patch = patches(triangles, printed, surrounding)
        count = len(triangles)
        self._printed = np.outer(patch.area, stiffness)
        gradients, second = patch.first[:, 1:].reshape(count, 4), patch.second.reshape(count, 9)
        params = np.column_stack([self._printed, gradients, second])
        dofs = (3 * patch.vertices[:, :, None] + np.arange(3)).reshape(count, 18)
        super().__init__(dofs, dofs, params)

    def set_rest_area(self, area_ratio: float) -> None:
        """Set the rest area over the printed area, the same for all patches."""
        self.params[:, :4] = area_ratio * self._printed


def _build(mesh: BendingMesh, stiffness: BendingStiffness) -> dict[str, Elements]:
    hinges = mesh.hinges
    return {
        "plate": Plate(mesh.triangles, mesh.printed, stiffness, mesh.surrounding),
        "folds": Hinges(hinges, 0.0, fold_coefficients(hinges, mesh.printed, stiffness.mean)),
    }


def _set_rest(
    parts: Mapping[str, Elements], stiffness: BendingStiffness, area_ratio: float, shape: Array | None
) -> None:
    cast(Plate, parts["plate"]).set_rest_area(area_ratio)
    if shape is not None:
        folds = cast(Hinges, parts["folds"])
        folds.params[:, 1] = fold_coefficients(folds.vertices, shape, stiffness.mean)


PLATE = FabricBending(("plate", "folds"), _build, _set_rest, needs_neighbours=True)
FABRIC_BENDING.update(plate=PLATE, consistent=PLATE)
