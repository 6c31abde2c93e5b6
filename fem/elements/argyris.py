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

import numpy as np
from skfem import ElementTriArgyris, MeshTri
from skfem.assembly.dofs import Dofs
from skfem.quadrature import get_quadrature

from fem.elements.location import triangles_at
from fem.elements.monomials import monomials, polynomials, powers
from fem.elements.printed_mesh import checked_mesh
from fem.elements.tabulation import Evaluation, Floats, Ints, Tabulation

JetMap = Callable[[Floats], Floats]

ORDERS = np.array([0, 1, 1, 2, 2, 2])  # of the vertex dofs: value, derivatives 1, 2, 11, 22, 12
POWERS = powers(5)


class Argyris:
    """Quintic C1 functions: six dofs at a vertex, the normal derivative at the middle of an edge.

    Parameters
    ----------
    mesh : scikit-fem's, in printed mm; see `fem.elements.printed_mesh.checked_mesh`.

    Attributes
    ----------
    size : number N of scalar dofs.
    dofs : (T, 21) of the triangles: six for each vertex (value, 1, 2, 11, 22, 12), then those of the edges 01, 12, 02.
    vertex_dofs : (V, 6).
    edge_dofs : (F,) the normal derivative times the edge's length, in the order of `mesh.facets`.
    vertex_scale : (V,) mm; a vertex dof of order k is a derivative times this to the power k.
    normals : (F, 2) unit normals of the edges, right of the way from the lower vertex number to the higher.
    """

    smooth = True
    mid_normals = True
    degree = 5

    def __init__(self, mesh: MeshTri) -> None:
        self.mesh = mesh = checked_mesh(mesh)
        numbers = Dofs(mesh, ElementTriArgyris())
        self.size: int = numbers.N
        self.dofs: Ints = numbers.element_dofs.T.copy()
        self.vertex_dofs: Ints = numbers.nodal_dofs.T.copy()
        self.edge_dofs: Ints = numbers.facet_dofs[0].copy()
        corners = mesh.p.T[mesh.t.T]
        self._centre = corners.mean(axis=1)
        one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        self._areas = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
        self._scale = np.sqrt(self._areas)
        around = np.bincount(mesh.t.ravel())
        total = np.bincount(mesh.t.ravel(), np.tile(self._scale, 3))
        self.vertex_scale = np.asarray(total / around, dtype=float)
        self._vertex_scales: Floats = self.vertex_scale[:, None] ** ORDERS
        ends = mesh.p.T[mesh.facets]
        along = ends[1] - ends[0]
        self._lengths: Floats = np.sqrt((along**2).sum(axis=1))
        self.normals = np.column_stack([along[:, 1], -along[:, 0]]) / self._lengths[:, None]
        self._middles = 0.5 * (ends[0] + ends[1])
        self.coefficients = np.linalg.inv(self._functionals())
        self._tabulations: dict[int, Tabulation] = {}

    def _functionals(self) -> Floats:
        """(T, 21, 21) dofs of the scaled monomials of every triangle."""
        mesh, count = self.mesh, self.mesh.nelements
        every = np.arange(count)
        dofs = np.empty((count, 21, 21))
        for k in range(3):
            vertex = mesh.t[k]
            table = monomials(POWERS, self._local(every, mesh.p.T[vertex]))
            scale = (self.vertex_scale[vertex] / self._scale)[:, None] ** ORDERS
            dofs[:, 6 * k : 6 * k + 6] = np.swapaxes(table * scale[:, None], 1, 2)
            edge = mesh.t2f[k]
            first = monomials(POWERS, self._local(every, self._middles[edge]))[..., 1:3]
            scale = self._lengths[edge] / self._scale
            dofs[:, 18 + k] = np.einsum("tma,ta,t->tm", first, self.normals[edge], scale)
        return dofs

    def _local(self, triangles: Ints, points: Floats) -> Floats:
        return np.asarray((points - self._centre[triangles]) / self._scale[triangles, None])

    def jets(self, triangles: Ints, points: Floats) -> tuple[Ints, Floats]:
        """Dofs (n, m) and (n, m, 6) value and derivatives 1, 2, 11, 22, 12 of a triangle's functions at a point.

        Points (n, 2) in printed mm may lie outside of the triangles (n,): the polynomials go on.
        """
        table = monomials(POWERS, self._local(triangles, points)) / (self._scale[:, None, None] ** ORDERS)[triangles]
        return self.dofs[triangles], np.matmul(np.swapaxes(self.coefficients[triangles], 1, 2), table)

    def tabulate(self, order: int) -> Tabulation:
        """Quadrature exact for polynomials of degree `order`; the same object every time."""
        if order not in self._tabulations:
            self._tabulations[order] = self._tabulated(order)
        return self._tabulations[order]

    def _tabulated(self, order: int) -> Tabulation:
        local, share = get_quadrature(self.mesh.refdom, order)
        count, per = self.mesh.nelements, len(share)
        points = np.moveaxis(self.mesh.mapping().F(local), 0, 2)
        at = self._local(np.repeat(np.arange(count), per), points.reshape(-1, 2))
        table = (
            monomials(POWERS, at).reshape(count, per, len(POWERS), 6) / (self._scale[:, None] ** ORDERS)[:, None, None]
        )
        # one product for each triangle
        table = np.matmul(np.swapaxes(self.coefficients, 1, 2)[:, None], table)
        return Tabulation(
            dofs=self.dofs.copy(),
            values=np.ascontiguousarray(table[..., 0]),
            gradients=np.ascontiguousarray(table[..., 1:3]),
            hessians=np.ascontiguousarray(table[..., 3:]),
            weights=2.0 * self._areas[:, None] * share,
            points=np.ascontiguousarray(points),
        )

    def penalty(self, modulus: Floats | float = 1.0) -> None:
        """None: the functions are C1, so their slopes have no jumps."""

    def interpolate(self, jets: JetMap) -> Floats:
        """(N, 3) coefficients of a map of the printed sheet into space.

        `jets` takes (n, 2) mm to (n, 6, 3), its value and derivatives 1, 2, 11, 22, 12.
        """
        count = self.mesh.nvertices
        table = jets(np.concatenate([self.mesh.p.T, self._middles]) if self.mid_normals else self.mesh.p.T)
        out = np.empty((self.size, 3))
        out[self.vertex_dofs] = table[:count] * self._vertex_scales[..., None]
        if self.mid_normals:
            slopes = np.matmul(self.normals[:, None], table[count:, 1:3])[:, 0]
            out[self.edge_dofs] = slopes * self._lengths[:, None]
        return out

    def locate(self, points: Floats) -> Evaluation:
        """Value, gradient and Hessian at printed points (n, 2) mm."""
        points = np.asarray(points, dtype=float)
        triangles = triangles_at(self.mesh, points)
        local = self._local(triangles, points)

        def jets(x: Floats) -> Floats:
            out = np.empty((len(points), 6, x.shape[1]))
            polynomials(POWERS, np.matmul(self.coefficients, x[self.dofs]), self._scale, triangles, local, out)
            return out

        return Evaluation(lambda: self.jets(triangles, points), self.size, jets)
