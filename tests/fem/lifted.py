"""P2 or P3 triangles with a discrete Hessian (local discontinuous Galerkin, LDG).

The gradient of a continuous piecewise polynomial jumps across edges, so its Hessian has a line density there. The
discrete Hessian distributes this density over the two triangles of the edge (Bonito, Guignard, Nochetto and Yang 2023,
"Numerical analysis of the LDG method for large deformations of prestrained plates", eq. 2.13):

    H[x] = D^2 x - sum_e r_e([d_n x]) n n^T,      int r_e(f) p = int_e f {p}  for all polynomials p,

with the normal n of the edge e, the jump [ ] and the mean { } over both sides. Boundary edges have no lifting r_e.

The energy gets the penalty `gamma D/2 sum_e 1/|e| int_e [d_n x]^2` with the bending stiffness D. It makes the energy
coercive for every gamma > 0. If the rest metric jumps, the gradient of the exact solution jumps within the tangent
plane. Only the penalty is affected, by a part of order thickness^2/size^2.

The functions are Lagrange's (Ciarlet 1978, "The finite element method for elliptic problems", section 2.2). Mesh,
numbering and nodes are those of scikit-fem, whose elements of this kind have first derivatives only.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementTriP2, ElementTriP3, MeshTri
from skfem.quadrature import get_quadrature

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.argyris import triangles_at
from asterism.fem.elements.monomials import monomials, powers
from asterism.fem.elements.printed_mesh import checked_mesh
from asterism.fem.elements.tabulation import Evaluation, Tabulation

ELEMENTS = {2: ElementTriP2, 3: ElementTriP3}


class Lagrange:
    """Continuous P2 or P3 basis functions.

    Parameters
    ----------
    mesh : mesh of scikit-fem in printed mm; see `fem.elements.printed_mesh.checked_mesh`.
    degree : 2 or 3.

    Attributes
    ----------
    dofs : (T, m) numbers of the nodes of each triangle.
    nodes : (N, 2) mm, printed positions of the nodes.
    areas : (T,) mm^2.

    Raises
    ------
    ValueError
        The degree is neither 2 nor 3, or the mesh is not admissible.

    Examples
    --------
    >>> space = Lagrange(MeshTri(), degree=2)
    >>> len(space.nodes)
    9
    >>> points, weights = space.quadrature(2)
    >>> round(float((weights * points[..., 0] ** 2).sum()), 6)  # int x^2 over the unit square
    0.333333
    """

    def __init__(self, mesh: MeshTri, degree: int) -> None:
        if degree not in ELEMENTS:
            raise ValueError(f"degree = {degree}: must be 2 or 3")
        mesh = checked_mesh(mesh)
        element = ELEMENTS[degree]()
        basis = Basis(mesh, element, intorder=1)
        self.mesh, self.degree = mesh, degree
        self.dofs: Ints = basis.element_dofs.T.copy()
        self.nodes: Floats = basis.doflocs.T.copy()
        self._powers = powers(degree)
        self._coefficients = np.linalg.inv(monomials(self._powers, element.doflocs)[..., 0])
        corners = mesh.p.T[mesh.t.T]
        self._origin = corners[:, 0]
        self._jacobian = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)
        self._inverse = np.linalg.inv(self._jacobian)
        self.areas: Floats = 0.5 * np.abs(np.linalg.det(self._jacobian))

    def local(self, triangles: Ints, points: Floats) -> Floats:
        """(n, 2) reference coordinates of printed points (n, 2): the corners are (0, 0), (1, 0), (0, 1)."""
        return np.asarray(np.einsum("nab,nb->na", self._inverse[triangles], points - self._origin[triangles]))

    def jets(self, triangles: Ints, points: Floats) -> Floats:
        """(n, m, 6) value and derivatives 1, 2, 11, 22, 12 of the functions of a triangle at a printed point (n, 2)."""
        table = np.einsum("nka,km->nma", monomials(self._powers, self.local(triangles, points)), self._coefficients)
        inverse = self._inverse[triangles]
        first = np.einsum("nma,nab->nmb", table[..., 1:3], inverse)
        second = np.einsum("nmab,nac,nbd->nmcd", table[..., [[3, 5], [5, 4]]], inverse, inverse)
        return np.concatenate(
            [table[..., :1], first, second[..., 0, 0, None], second[..., 1, 1, None], second[..., 0, 1, None]], axis=2
        )

    def quadrature(self, order: int) -> tuple[Floats, Floats]:
        """Printed points (T, Q, 2) and weights (T, Q) mm^2 of a quadrature exact for polynomials of degree `order`."""
        local, weights = get_quadrature(self.mesh.refdom, order)
        points = self._origin[:, None] + np.einsum("tab,bq->tqa", self._jacobian, local)
        return points, 2.0 * self.areas[:, None] * weights


class Lifted:
    """Continuous P2 or P3 functions with a discrete Hessian that includes the jumps of their gradient.

    Parameters
    ----------
    mesh : mesh of scikit-fem in printed mm; see `fem.elements.printed_mesh.checked_mesh`.
    degree : 2 or 3.
    gamma : factor of the penalty on slope jumps.

    Attributes
    ----------
    size : number N of scalar dofs.
    nodes : (N, 2) mm; a dof is the value at its node.

    Raises
    ------
    ValueError
        The degree is neither 2 nor 3, or the mesh is not admissible.

    Examples
    --------
    The discrete Hessian of a quadratic is exact:

    >>> space = Lifted(MeshTri().refined(1), degree=2)
    >>> x, y = space.nodes.T
    >>> hessian = space.locate(np.array([[0.3, 0.6]])).jets((x**2 + 3 * x * y)[:, None])[0, 3:, 0]
    >>> hessian.round(6) + 0.0  # derivatives 11, 22, 12
    array([2., 0., 3.])
    """

    smooth = False
    mid_normals = False

    def __init__(self, mesh: MeshTri, degree: int = 3, gamma: float = 1.0) -> None:
        self.degree, self.gamma = degree, gamma
        self._basis = Lagrange(mesh, degree)
        self.mesh = mesh = self._basis.mesh
        self.nodes = self._basis.nodes
        self.size = len(self.nodes)
        self._powers = powers(degree - 1)
        self._orthonormal = _orthonormal(self._powers)
        self._inner_edges = np.flatnonzero(mesh.f2t[1] >= 0)
        self._build_stencils()

    def tabulate(self, order: int) -> Tabulation:
        """Tabulation at a quadrature exact for polynomials of degree `order`."""
        points, weights = self._basis.quadrature(order)
        count, per = weights.shape
        triangles = np.repeat(np.arange(count), per)
        jets = self._lifted_jets(triangles, points.reshape(-1, 2)).reshape(count, per, -1, 6)
        return Tabulation(
            dofs=self._dofs,
            values=np.ascontiguousarray(jets[..., 0]),
            gradients=np.ascontiguousarray(jets[..., 1:3]),
            hessians=np.ascontiguousarray(jets[..., 3:]),
            weights=weights,
            points=points,
        )

    def penalty(self, modulus: Floats | float = 1.0) -> sp.csr_matrix:
        """(N, N) N/mm, matrix P of the penalty: the energy is `x P x/2`, summed over the components of the position.

        `modulus` is the bending stiffness in N mm, a number or (T,); an edge takes the mean of its two triangles.
        """
        modulus = np.broadcast_to(np.asarray(modulus, dtype=float), self.mesh.nelements)
        sides, jumps, weights = self._jumps()
        length = weights.sum(axis=1)
        scale = self.gamma * modulus[sides].mean(axis=0) / length
        blocks = np.einsum("e,eg,egi,egj->eij", scale, weights, jumps, jumps)
        dofs = np.hstack([self._basis.dofs[sides[0]], self._basis.dofs[sides[1]]])
        rows, columns = np.repeat(dofs, dofs.shape[1], axis=1), np.tile(dofs, dofs.shape[1])
        return sp.csr_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(self.size, self.size))

    def interpolate(self, jets: Callable[[Floats], Floats]) -> Floats:
        """(N, 3) coefficients of the interpolant of a map from points (n, 2) to (n, 6, 3); only its value is used."""
        return np.ascontiguousarray(jets(self.nodes)[:, 0])

    def jets(self, triangles: Ints, points: Floats) -> tuple[Ints, Floats]:
        """Dofs (n, m), and (n, m, 6) value and piecewise derivatives 1, 2, 11, 22, 12 of their functions."""
        return self._basis.dofs[triangles], self._basis.jets(triangles, points)

    def locate(self, points: Floats) -> Evaluation:
        """Evaluation of value, gradient and discrete Hessian at printed points (n, 2) mm of the sheet."""
        points = np.asarray(points, dtype=float)
        triangles = triangles_at(self.mesh, points)
        return Evaluation(lambda: (self._dofs[triangles], self._lifted_jets(triangles, points)), self.size)

    def _lifted_jets(self, triangles: Ints, points: Floats) -> Floats:
        """(n, M, 6) value, gradient and discrete Hessian of all functions of the stencil of a triangle."""
        piecewise = self._basis.jets(triangles, points)
        jets = np.zeros((len(triangles), self._dofs.shape[1], 6))
        rows = np.arange(len(triangles))[:, None]
        jets[rows, self._slots[triangles, : piecewise.shape[1]]] = piecewise
        functions = self._functions(triangles, points)
        jets[..., 3:] -= np.einsum("nj,njmc->nmc", functions, self._lifting[triangles])
        return jets

    def _functions(self, triangles: Ints, points: Floats) -> Floats:
        """(n, J) polynomials of degree k - 1 at points, orthonormal over their triangle."""
        table = monomials(self._powers, self._basis.local(triangles, points))[..., 0] @ self._orthonormal
        return table / np.sqrt(2.0 * self._basis.areas[triangles, None])

    def _jumps(self) -> tuple[Ints, Floats, Floats]:
        """Triangles (2, e) of the inner edges, jumps (e, G, 2m) of their normal derivatives, weights (e, G) mm."""
        points, normals, weights = self._edge_points()
        sides = self.mesh.f2t[:, self._inner_edges]
        count, per = weights.shape
        normal = np.repeat(normals, per, axis=0)
        both = []
        for sign, triangles in zip((1.0, -1.0), sides, strict=True):
            first = self._basis.jets(np.repeat(triangles, per), points.reshape(-1, 2))[..., 1:3]
            both.append(sign * np.einsum("nma,na->nm", first, normal).reshape(count, per, -1))
        return sides, np.concatenate(both, axis=2), weights

    def _edge_points(self) -> tuple[Floats, Floats, Floats]:
        """Gauss points (e, G, 2), outward normals (e, 2) of the first triangle, weights (e, G) of the inner edges."""
        ends = self.mesh.p.T[self.mesh.facets[:, self._inner_edges]]
        gauss, share = np.polynomial.legendre.leggauss(self.degree + 1)
        along = ends[1] - ends[0]
        points = ends[0][:, None] + 0.5 * (gauss[:, None] + 1.0) * along[:, None]
        length = np.linalg.norm(along, axis=1)
        normals = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
        centre = self.mesh.p[:, self.mesh.t[:, self.mesh.f2t[0, self._inner_edges]]].mean(axis=1).T
        normals *= np.sign(np.sum(normals * (ends[0] - centre), axis=1))[:, None]
        return points, normals, 0.5 * share * length[:, None]

    def _build_stencils(self) -> None:
        """Set the dofs (T, M) of each triangle and its neighbours, and the lifting (T, J, M, 3) of each function."""
        sides, jumps, weights = self._jumps()
        points, normals, _ = self._edge_points()
        count, per = weights.shape
        nodes = self._basis.dofs
        m, triangles = nodes.shape[1], len(nodes)
        normal_squares = np.column_stack([normals[:, 0] ** 2, normals[:, 1] ** 2, normals[:, 0] * normals[:, 1]])
        # nodes of the triangle, then those of up to three neighbours; a missing neighbour repeats the triangle
        stencil = np.tile(nodes, 4)
        lifting = np.zeros((triangles, self._orthonormal.shape[1], 4 * m, 3))
        neighbours = np.zeros(triangles, dtype=int)
        for side, opposite in ((0, 1), (1, 0)):
            functions = self._functions(np.repeat(sides[side], per), points.reshape(-1, 2)).reshape(count, per, -1)
            parts = 0.5 * np.einsum("eg,egj,egi->eji", weights, functions, jumps)
            parts = np.concatenate([parts[..., m * side :][..., :m], parts[..., m * opposite :][..., :m]], axis=2)
            parts = parts[..., None] * normal_squares[:, None, None]
            for e in range(count):
                t = sides[side, e]
                neighbours[t] += 1
                block = slice(m * neighbours[t], m * neighbours[t] + m)
                stencil[t, block] = nodes[sides[opposite, e]]
                lifting[t, :, :m] += parts[e, :, :m]
                lifting[t, :, block] += parts[e, :, m:]
        # the assembly needs each dof once in a stencil: equal dofs are merged and their liftings added
        ordered = np.sort(stencil, axis=1)
        first_of_kind = np.ones_like(ordered, dtype=bool)
        first_of_kind[:, 1:] = ordered[:, 1:] != ordered[:, :-1]
        rank = np.cumsum(first_of_kind, axis=1) - 1
        width = int(rank[:, -1].max()) + 1
        rows = np.arange(triangles)[:, None]
        self._dofs = np.repeat(nodes[:, :1], width, axis=1)
        self._dofs[rows, rank] = ordered
        self._slots = np.empty_like(stencil)
        self._slots[rows, np.argsort(stencil, axis=1, kind="stable")] = rank
        self._lifting = np.zeros((triangles, lifting.shape[1], width, 3))
        for column in range(stencil.shape[1]):
            self._lifting[rows[:, 0], :, self._slots[:, column]] += lifting[:, :, column]


def _orthonormal(exponents: Ints) -> Floats:
    """(k, J) combinations of monomials that are orthonormal over the reference triangle (0, 0), (1, 0), (0, 1)."""
    a, b = (exponents[:, None, i] + exponents[None, :, i] for i in (0, 1))
    factorial = np.cumprod(np.r_[1.0, np.arange(1.0, 2 * exponents.max() + 3)])
    gram = factorial[a] * factorial[b] / factorial[a + b + 2]
    return np.linalg.inv(np.linalg.cholesky(gram)).T
