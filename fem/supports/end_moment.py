"""A moment along an edge, about an axis that is fixed in space.

The moment acts on the fibres that cross the edge. With the derivative p of the position across the edge and the angle
psi of its projection on the plane normal to the axis, the potential is `-int m psi ds`. The moment is conservative and
exact for rotations of any size, also for fibres that tilt to the axis.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.space import Space
from asterism.fem.supports.edge_curve import left
from asterism.fem.supports.loads import edge_points


class EndMoment:
    """Potential of a moment on mesh edges.

    Parameters
    ----------
    space : discretisation.
    facets : (n,) mesh edges.
    moment : N, that is N mm per printed mm of edge; right-handed about the axis.
    axis : (3,) direction, of any length.
    near : rad, expected angle from the printed fibre; psi is counted within pi of it. Only the value of the energy
        depends on it.

    Raises
    ------
    ValueError
        The axis is parallel to the fibres.
    """

    def __init__(self, space: Space, facets: Ints, moment: float, axis: ArrayLike, near: float = 0.0) -> None:
        triangles, points, weights = edge_points(space, facets)
        a, b = space.mesh.p.T[space.mesh.facets[:, facets]]
        outward = left(b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
        inside = space.mesh.p.T[space.mesh.t.T].mean(axis=1)[space.mesh.f2t[0, facets]]
        outward *= np.sign(np.sum(outward * (a - inside), axis=1))[:, None]
        dofs, jets = space.jets(triangles, points)
        self.dofs: Ints = dofs
        self.size, self.moment, self.near = space.size, moment, near
        per = len(points) // len(facets)
        self._across = np.einsum("nma,na->nm", jets[..., 1:3], np.repeat(outward, per, axis=0))
        self._weights = weights
        self._plane = _plane(np.asarray(axis, dtype=float), outward.mean(axis=0))

    def energy(self, positions: Floats) -> float:
        """N mm, potential at positions (N, 3)."""
        a, b = self._projected(positions)
        # within pi of `near`
        angle = self.near + np.angle((a + 1j * b) * np.exp(-1j * self.near))
        return -self.moment * float(self._weights @ angle)

    def gradient(self, positions: Floats) -> Floats:
        """(N, 3) N, gradient of the potential."""
        a, b = self._projected(positions)
        slope = np.stack([-b, a]) / (a * a + b * b)
        forces = -self.moment * self._weights[:, None] * np.einsum("kn,kr->nr", slope, self._plane)
        out = np.zeros((self.size, 3))
        np.add.at(out, self.dofs, self._across[:, :, None] * forces[:, None])
        return out

    def hessian(self, positions: Floats) -> sp.csr_matrix:
        """(3N, 3N) N/mm, Hessian of the potential."""
        a, b = self._projected(positions)
        twice, difference = 2.0 * a * b, b * b - a * a
        second = np.stack([np.stack([twice, difference]), np.stack([difference, -twice])]) / (a * a + b * b) ** 2
        block = np.einsum("n,kln,kr,ls->nrs", -self.moment * self._weights, second, self._plane, self._plane)
        table = np.einsum("ni,nj,nrs->nirjs", self._across, self._across, block)
        dofs = (3 * self.dofs[:, :, None] + np.arange(3)).reshape(len(self.dofs), -1)
        rows, columns = np.repeat(dofs, dofs.shape[1], axis=1), np.tile(dofs, dofs.shape[1])
        return sp.csr_matrix((table.ravel(), (rows.ravel(), columns.ravel())), shape=(3 * self.size,) * 2)

    def _projected(self, positions: Floats) -> Floats:
        """(2, n) components of the fibres in the plane normal to the axis."""
        fibres = np.einsum("nm,nmr->nr", self._across, positions[self.dofs])
        return np.asarray(self._plane @ fibres.T)


def _plane(axis: Floats, fibre: Floats) -> Floats:
    """(2, 3) orthonormal basis of the plane normal to the axis, right-handed; psi = 0 along the printed fibre (2,)."""
    axis = axis / np.linalg.norm(axis)
    across = np.append(fibre / np.linalg.norm(fibre), 0.0)
    first = across - (across @ axis) * axis
    length = np.linalg.norm(first)
    if length < 1e-6:
        raise ValueError("end moment: the axis is parallel to the fibres that the moment rotates")
    first /= length
    return np.stack([first, np.cross(axis, first)])
