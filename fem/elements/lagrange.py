"""Lagrange triangles P2 and P3 with first and second derivatives.

The functions are continuous piecewise polynomials (Ciarlet 1978, "The finite element method for elliptic problems",
section 2.2). `fem.elements.lifted` builds a discrete Hessian from their piecewise derivatives. Mesh, numbering and
nodes are those of scikit-fem, whose elements of this kind have first derivatives only.
"""

from __future__ import annotations

import numpy as np
from skfem import Basis, ElementTriP2, ElementTriP3, MeshTri
from skfem.quadrature import get_quadrature

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.monomials import monomials, powers
from asterism.fem.elements.printed_mesh import checked_mesh

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
