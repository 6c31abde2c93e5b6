"""The quintic triangle without mid-edge dofs (Bell 1969)."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.argyris import Argyris


class Bell(Argyris):
    """Argyris triangle with a cubic normal derivative along every edge: 18 dofs, all at vertices.

    Contains all polynomials up to degree 4 and some of degree 5, so it converges one order slower.
    """

    mid_normals = False

    def __init__(self, mesh: MeshTri) -> None:
        super().__init__(mesh)
        self.coefficients = self.coefficients @ self._reduction()
        self.dofs = self.dofs[:, :18].copy()
        self.size = int(6 * self.mesh.nvertices)
        self.edge_dofs = np.empty(0, dtype=np.int64)

    def _reduction(self) -> Floats:
        """(T, 21, 18) all dofs from those of the vertices.

        A cubic with end values s0, s1 and end slopes d0, d1 over the length L is (s0 + s1)/2 + L (d0 - d1)/8 in the
        middle.
        """
        mesh = self.mesh
        full = np.zeros((mesh.nelements, 21, 18))
        full[:, :18] = np.eye(18)
        for k, (a, b) in enumerate([(0, 1), (1, 2), (0, 2)]):
            edge = mesh.t2f[k]
            n, length = self.normals[edge], self._lengths[edge]
            t = np.column_stack([-n[:, 1], n[:, 0]])  # from the lower vertex number to the higher
            bend = np.column_stack([n[:, 0] * t[:, 0], n[:, 1] * t[:, 1], n[:, 0] * t[:, 1] + n[:, 1] * t[:, 0]])
            for vertex, sign in ((a, 1.0), (b, -1.0)):
                scale = self.vertex_scale[mesh.t[vertex]][:, None]
                full[:, 18 + k, 6 * vertex + 1 : 6 * vertex + 3] = 0.5 * length[:, None] * n / scale
                full[:, 18 + k, 6 * vertex + 3 : 6 * vertex + 6] = sign * (length**2)[:, None] / 8.0 * bend / scale**2
        return full
