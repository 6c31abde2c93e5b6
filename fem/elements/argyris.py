"""Argyris triangles: conforming C1 quintics (Argyris, Fried and Scharpf 1968, "The TUBA family of plate elements").

On each triangle the functions are the 21 polynomials of degree 5. The dofs are the value and all derivatives up to the
second at the vertices, and the normal derivative at the edge midpoints. They determine value and normal derivative
along every edge, so the functions are C1 and the bending energy `int K : D : K` is defined without jump terms.

Mesh, numbering of the dofs and quadrature are those of scikit-fem. The basis is computed here, because scikit-fem uses
global monomials, whose condition number is 1e17 and more for a sheet in mm. Here the monomials of each triangle are
centred and scaled, and a dof of derivative order k is the derivative times a length to the power k: all dofs are in mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from jaxtyping import Float, Int
from numpy.typing import ArrayLike
from scipy.sparse.csgraph import connected_components
from skfem import ElementTriArgyris, ElementTriP1, MeshTri
from skfem.assembly.dofs import Dofs
from skfem.quadrature import get_quadrature

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop
from asterism.fem.elements.deformation import affine, flat

JetMap = Callable[[Floats], Floats]
DEGREE = 5
# exponents (21, 2) of all monomials: degree by degree, the first one rising
POWERS: Ints = np.array([(i, n - i) for n in range(DEGREE + 1) for i in range(n + 1)])
# order of the derivatives 0, 1, 2, 11, 22, 12 by the first and by the second variable
_BY = np.array([(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1)])
# (21, 6, 2) exponents of the derivatives; -1 and -2 belong to derivatives that are zero
_LEFT = POWERS[:, None] - _BY
# (21, 6) factors of the derivatives
_FACTORS = np.prod([np.where(k < _BY, POWERS[:, None] - k, 1) for k in (0, 1)], axis=(0, -1)).astype(float)
ORDERS = np.array([0, 1, 1, 2, 2, 2])  # order of derivative of the vertex dofs: value, 1, 2, 11, 22, 12
MAX_OUTSIDE = 0.3  # heights of a triangle, largest distance of a point outside the mesh


@dataclass(frozen=True)
class Tabulation:
    """Scalar basis functions of T triangles at Q quadrature points each; lengths are printed mm."""

    # (T, m) scalar dofs of each triangle's stencil, the same for the three components of the position.
    dofs: Int[np.ndarray, "T m"]
    values: Float[np.ndarray, "T Q m"]  # (T, Q, m)
    gradients: Float[np.ndarray, "T Q m 2"]  # (T, Q, m, 2) derivatives 1, 2
    hessians: Float[np.ndarray, "T Q m 3"]  # (T, Q, m, 3) derivatives 11, 22, 12
    weights: Float[np.ndarray, "T Q"]  # (T, Q) mm^2 of printed area
    points: Float[np.ndarray, "T Q 2"]  # (T, Q, 2) mm


class Argyris:
    """Quintic C1 functions: six dofs at each vertex, one normal derivative at each edge midpoint.

    Raises `ValueError` if the mesh is not admissible.

    `mesh`: mesh of scikit-fem in printed mm; see `checked_mesh`.

    The unit square has 4 x 6 vertex dofs and 5 edge dofs. The parabola `z = x^2/20` is interpolated exactly:

    >>> space = Argyris(MeshTri())
    >>> space.size
    29
    >>> def parabola(p):  # position and derivatives 1, 2, 11, 22, 12
    ...     out = np.zeros((len(p), 6, 3))
    ...     out[:, 0, :2], out[:, 1, 0], out[:, 2, 1] = p, 1.0, 1.0
    ...     out[:, 0, 2], out[:, 1, 2], out[:, 3, 2] = p[:, 0] ** 2 / 20, p[:, 0] / 10, 0.1
    ...     return out
    >>> jet = space.locate(np.array([[0.4, 0.3]])).jets(space.interpolate(parabola))[0]
    >>> jet[0].round(6), jet[3].round(6) + 0.0
    (array([0.4  , 0.3  , 0.008]), array([0. , 0. , 0.1]))
    """

    def __init__(self, mesh: MeshTri) -> None:
        self.mesh = mesh = checked_mesh(mesh)
        numbers = Dofs(mesh, ElementTriArgyris())
        self.size = int(numbers.N)  # number N of scalar dofs
        # (T, 21) of the triangles: six for each vertex (value, 1, 2, 11, 22, 12), then those of the edges 01, 12, 02
        self.dofs: Ints = numbers.element_dofs.T.copy()
        self.vertex_dofs: Ints = numbers.nodal_dofs.T.copy()  # (V, 6)
        # (F,) the normal derivative times the edge's length, in the order of `mesh.facets`
        self.edge_dofs: Ints = numbers.facet_dofs[0].copy()
        corners = mesh.p.T[mesh.t.T]
        self._centre = corners.mean(axis=1)
        side1, side2 = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        self._areas = 0.5 * np.abs(side1[:, 0] * side2[:, 1] - side1[:, 1] * side2[:, 0])
        self._scale = np.sqrt(self._areas)
        triangles_at_vertex = np.bincount(mesh.t.ravel())
        total = np.bincount(mesh.t.ravel(), np.tile(self._scale, 3))
        # (V,) mm; a vertex dof of order k is a derivative times this to the power k
        self.vertex_scale = np.asarray(total / triangles_at_vertex, dtype=float)
        self._vertex_scales: Floats = self.vertex_scale[:, None] ** ORDERS
        ends = mesh.p.T[mesh.facets]
        along = ends[1] - ends[0]
        self._lengths: Floats = np.sqrt((along**2).sum(axis=1))
        # (F, 2) unit normals of the edges, on the right of the direction from the lower to the higher vertex
        self.normals = np.column_stack([along[:, 1], -along[:, 0]]) / self._lengths[:, None]
        self._midpoints = 0.5 * (ends[0] + ends[1])
        self.coefficients = np.linalg.inv(self._functionals())
        self._tabulations: dict[int, Tabulation] = {}

    def _functionals(self) -> Floats:
        """(T, 21, 21) dofs (rows) of the scaled monomials (columns) of every triangle."""
        mesh, count = self.mesh, self.mesh.nelements
        triangles = np.arange(count)
        dofs = np.empty((count, 21, 21))
        for k in range(3):
            vertex = mesh.t[k]
            table = monomials(self._local(triangles, mesh.p.T[vertex]))
            scale = (self.vertex_scale[vertex] / self._scale)[:, None] ** ORDERS
            dofs[:, 6 * k : 6 * k + 6] = np.swapaxes(table * scale[:, None], 1, 2)
            edge = mesh.t2f[k]
            first = monomials(self._local(triangles, self._midpoints[edge]))[..., 1:3]
            scale = self._lengths[edge] / self._scale
            dofs[:, 18 + k] = np.einsum("tma,ta,t->tm", first, self.normals[edge], scale)
        return dofs

    def _local(self, triangles: Ints, points: Floats) -> Floats:
        return np.asarray((points - self._centre[triangles]) / self._scale[triangles, None])

    def jets(self, triangles: Ints, points: Floats) -> tuple[Ints, Floats]:
        """Dofs (n, m), and (n, m, 6) value and derivatives 1, 2, 11, 22, 12 of the functions of a triangle at a point.

        Points (n, 2) in printed mm may lie outside their triangles (n,); the polynomials are extrapolated.
        """
        table = monomials(self._local(triangles, points)) / (self._scale[:, None, None] ** ORDERS)[triangles]
        return self.dofs[triangles], np.matmul(np.swapaxes(self.coefficients[triangles], 1, 2), table)

    def tabulate(self, order: int) -> Tabulation:
        """Tabulation at a quadrature exact for polynomials of degree `order`; computed once for each order."""
        if order not in self._tabulations:
            self._tabulations[order] = self._tabulated(order)
        return self._tabulations[order]

    def _tabulated(self, order: int) -> Tabulation:
        local, share = get_quadrature(self.mesh.refdom, order)
        count, per = self.mesh.nelements, len(share)
        points = np.moveaxis(self.mesh.mapping().F(local), 0, 2)
        at = self._local(np.repeat(np.arange(count), per), points.reshape(-1, 2))
        table = monomials(at).reshape(count, per, len(POWERS), 6) / (self._scale[:, None] ** ORDERS)[:, None, None]
        # a single matrix product for each triangle
        table = np.matmul(np.swapaxes(self.coefficients, 1, 2)[:, None], table)
        return Tabulation(
            dofs=self.dofs.copy(),
            values=np.ascontiguousarray(table[..., 0]),
            gradients=np.ascontiguousarray(table[..., 1:3]),
            hessians=np.ascontiguousarray(table[..., 3:]),
            weights=2.0 * self._areas[:, None] * share,
            points=np.ascontiguousarray(points),
        )

    @cached_property
    def flat(self) -> Floats:
        """(N, 3) mm, coefficients of the printed sheet in the plane z = 0."""
        return self.interpolate(flat().jets)

    @cached_property
    def ones(self) -> Floats:
        """(N,) coefficients of the function one."""
        return np.ascontiguousarray(self.interpolate(affine(np.zeros((3, 2)), (1.0, 0.0, 0.0)).jets)[:, 0])

    def interpolate(self, jets: JetMap) -> Floats:
        """(N, 3) coefficients of the interpolant of a map of the printed sheet into space.

        `jets` maps printed points (n, 2) mm to (n, 6, 3): position and derivatives 1, 2, 11, 22, 12.
        """
        count = self.mesh.nvertices
        table = jets(np.concatenate([self.mesh.p.T, self._midpoints]))
        out = np.empty((self.size, 3))
        out[self.vertex_dofs] = table[:count] * self._vertex_scales[..., None]
        slopes = np.matmul(self.normals[:, None], table[count:, 1:3])[:, 0]
        out[self.edge_dofs] = slopes * self._lengths[:, None]
        return out

    def locate(self, points: Floats) -> Evaluation:
        """Evaluation at printed points (n, 2) mm; ValueError outside the sheet."""
        return Evaluation(self, np.asarray(points, dtype=float))


class Evaluation:
    """Evaluation of the functions of a space at n printed points (n, 2) mm."""

    def __init__(self, space: Argyris, points: Floats) -> None:
        self._space, self._points = space, points
        self._triangles = triangles_at(space.mesh, points)
        self._local = space._local(self._triangles, points)

    def jets(self, x: Floats) -> Floats:
        """(n, 6, k) value and derivatives 1, 2, 11, 22, 12 of functions with coefficients x (N, k)."""
        space, out = self._space, np.empty((len(self._points), 6, x.shape[1]))
        factors = np.matmul(space.coefficients, x[space.dofs])
        polynomials(factors, space._scale, self._triangles, self._local, out)
        return out

    @cached_property
    def value(self) -> sp.csr_matrix:
        """(n, N) matrix from coefficients to values."""
        dofs, jets = self._space.jets(self._triangles, self._points)
        ends = dofs.shape[1] * np.arange(len(dofs) + 1)
        return sp.csr_matrix((jets[..., 0].ravel(), dofs.ravel(), ends), shape=(len(dofs), self._space.size))


def monomials(points: Floats) -> Floats:
    """(n, 21, 6) values and derivatives 1, 2, 11, 22, 12 of the monomials at points (n, 2)."""
    ladder = np.ones((2, len(points), DEGREE + 1))
    for power in range(1, DEGREE + 1):
        ladder[:, :, power] = ladder[:, :, power - 1] * points.T
    first, second = np.moveaxis(np.maximum(_LEFT, 0), -1, 0)
    return np.asarray(_FACTORS * ladder[0].take(first, axis=1) * ladder[1].take(second, axis=1))


@loop
def polynomials(factors, scale, pieces, points, out):  # type: ignore[no-untyped-def]
    """Write values and derivatives 1, 2, 11, 22, 12 of c piecewise polynomials at points (n, 2) to out (n, 6, c).

    `pieces` (n,) are the pieces of the points, `factors` (T, k, c) the coefficients of a piece in the order of
    `POWERS`, and `scale` (T,) its unit of length; points are in this unit. Horner's scheme, first along the
    second coordinate and then along the first one.
    """
    for p in range(points.shape[0]):
        coefficients, unit = factors[pieces[p]], 1.0 / scale[pieces[p]]
        square = unit * unit
        u, v = points[p]
        for c in range(coefficients.shape[1]):
            f = f1 = f11 = f2 = f12 = f22 = 0.0  # of second derivatives in the same coordinate the half
            for i in range(DEGREE, -1, -1):
                q = q2 = q22 = 0.0
                for n in range(DEGREE, i - 1, -1):
                    q22 = q22 * v + q2
                    q2 = q2 * v + q
                    q = q * v + coefficients[n * (n + 1) // 2 + i, c]
                f11 = f11 * u + f1
                f1 = f1 * u + f
                f = f * u + q
                f12 = f12 * u + f2
                f2 = f2 * u + q2
                f22 = f22 * u + q22
            out[p, 0, c], out[p, 1, c], out[p, 2, c] = f, f1 * unit, f2 * unit
            out[p, 3, c], out[p, 4, c], out[p, 5, c] = 2.0 * f11 * square, 2.0 * f22 * square, f12 * square


def area_load(space: Argyris, force: ArrayLike | Callable[[Floats], Floats]) -> Floats:
    """(N, 3) N, forces `F_i = int f phi_i` on the dofs, of a dead load f per printed area: it keeps size and direction.

    The potential at positions x is `-sum(F * x)`, its Hessian is zero, and the total force is constant.

    `force`: N/mm^2, (3,) or a function of printed points (n, 2) mm to (n, 3). Gravity is (0, 0, -weight per area).

    A plate of 1 mm^2 that weighs 2 N; the sum over the dofs that are positions is the weight:

    >>> from skfem import MeshTri
    >>> space = Argyris(MeshTri())
    >>> area_load(space, (0.0, 0.0, -2.0))[space.vertex_dofs[:, 0]].sum(axis=0).round(6) + 0.0
    array([ 0.,  0., -2.])
    """
    table = space.tabulate(2 * DEGREE)
    values = np.asarray(force(table.points.reshape(-1, 2)) if callable(force) else force, dtype=float)
    at = np.broadcast_to(values, (table.weights.size, 3)).reshape(*table.weights.shape, 3)
    loads = np.zeros((space.size, 3))
    np.add.at(loads, table.dofs, np.einsum("tq,tqm,tqr->tmr", table.weights, table.values, at))
    return loads


def triangles_at(mesh: MeshTri, points: Floats) -> Ints:
    """(n,) triangles of printed points (n, 2).

    A point slightly outside the mesh gets the triangle in which its smallest barycentric coordinate is largest. Raises
    `ValueError` if a point is further outside than MAX_OUTSIDE; the message names the first one.

    >>> triangles_at(MeshTri(), np.array([[0.1, 0.2], [0.9, 0.7], [1.05, 0.9]])).tolist()
    [0, 1, 1]
    """
    points = np.asarray(points, dtype=float)
    mapping = mesh.mapping()
    slopes = np.moveaxis(mapping.invA, 2, 0)  # gradients of the two reference coordinates of every triangle
    origin = np.einsum("tab,bt->ta", slopes, mapping.b)
    triangles, depth = np.empty(len(points), dtype=np.int64), np.empty(len(points))
    _search(np.ascontiguousarray(slopes), origin, points, triangles, depth)
    outside = np.flatnonzero(depth < -MAX_OUTSIDE)
    if len(outside):
        x, y = points[outside[0]]
        raise ValueError(f"point ({x:g}, {y:g}) is outside the sheet")
    return triangles


@loop
def _search(slopes, origin, points, triangles, depth):  # type: ignore[no-untyped-def]
    """Write the triangle in which each point lies deepest, and its depth: the smallest barycentric coordinate there.

    The finder of scikit-fem refuses points that rounding has moved over the border.
    """
    last = 0
    for p in range(points.shape[0]):
        x, y = points[p]
        best, deepest = last, -np.inf
        for number in range(-1, len(slopes)):
            t = last if number < 0 else number  # the next point is often in the same triangle
            u = slopes[t, 0, 0] * x + slopes[t, 0, 1] * y - origin[t, 0]
            v = slopes[t, 1, 0] * x + slopes[t, 1, 1] * y - origin[t, 1]
            smallest = min(u, v, 1.0 - u - v)
            if smallest > deepest:
                best, deepest = t, smallest
            # heights of a triangle: a point at this depth is in this triangle only
            if smallest > 1e-6:
                break
        triangles[p], depth[p] = best, deepest
        last = best


def checked_mesh(mesh: MeshTri) -> MeshTri:
    """The mesh with the corners of every triangle in ascending order, which fixes the direction of its edges.

    Vertices, triangles and edges keep their numbers, and named boundaries their edges. Raises `ValueError` if a
    triangle is curved, degenerate or not finite; a vertex belongs to no triangle; an edge has more than two triangles;
    or the mesh is not connected.
    """
    if mesh.elem is not ElementTriP1:
        raise ValueError("mesh: triangles must have straight edges, as those of MeshTri")
    if mesh.t.size == 0:
        raise ValueError("mesh: has no triangles")
    if not np.isfinite(mesh.p).all():
        raise ValueError("mesh: a vertex is not finite")
    size, t = mesh.p.shape[1], mesh.t
    unused = np.flatnonzero(np.bincount(t.ravel(), minlength=size) == 0)
    if len(unused):
        raise ValueError(f"mesh: vertex {unused[0]} belongs to no triangle")
    side1, side2 = (mesh.p[:, t[k]] - mesh.p[:, t[0]] for k in (1, 2))
    degenerate = np.flatnonzero(side1[0] * side2[1] == side1[1] * side2[0])
    if len(degenerate):
        raise ValueError(f"mesh: triangle {degenerate[0]} has no area")
    crowded = np.flatnonzero(np.bincount(mesh.t2f.ravel()) > 2)
    if len(crowded):
        raise ValueError(f"mesh: edge {crowded[0]} has more than two triangles")
    edges = sp.coo_array((np.ones(mesh.facets.shape[1]), tuple(mesh.facets)), shape=(size, size))
    pieces = connected_components(edges, directed=False, return_labels=False)
    if pieces > 1:
        raise ValueError(f"mesh: has {pieces} pieces that are not connected")
    return mesh if (np.diff(t, axis=0) > 0).all() else replace(mesh, t=np.sort(t, axis=0), sort_t=True)
