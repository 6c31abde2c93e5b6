"""Dead loads: forces that keep size and direction while the sheet moves.

Each function returns the forces F (N, 3) in N on the dofs of a space, `F_i = int f phi_i`. The potential at positions x
is `-sum(F * x)`, and its Hessian is zero. Densities are per printed area or length, so the total force is constant.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.space import Space

Force = ArrayLike | Callable[[Floats], Floats]


def area_load(space: Space, force: Force) -> Floats:
    """(N, 3) N, dead load of a force per printed area.

    Parameters
    ----------
    force : N/mm^2, (3,) or a function of printed points (n, 2) mm to (n, 3). Gravity is (0, 0, -weight per area).

    Examples
    --------
    A plate of 1 mm^2 that weighs 2 N; the sum over the dofs that are positions is the weight:

    >>> from skfem import MeshTri
    >>> from asterism.fem.elements.argyris import Argyris
    >>> space = Argyris(MeshTri())
    >>> area_load(space, (0.0, 0.0, -2.0))[space.vertex_dofs[:, 0]].sum(axis=0).round(6) + 0.0
    array([ 0.,  0., -2.])
    """
    table = space.tabulate(2 * space.degree)
    at = _values(force, table.points.reshape(-1, 2)).reshape(*table.weights.shape, 3)
    loads = np.zeros((space.size, 3))
    np.add.at(loads, table.dofs, np.einsum("tq,tqm,tqr->tmr", table.weights, table.values, at))
    return loads


def edge_load(space: Space, facets: Ints, force: Force) -> Floats:
    """(N, 3) N, dead load of a force per printed length of mesh edges (n,): N/mm, as `force` in `area_load`."""
    triangles, points, weights = edge_points(space, facets)
    return _gather(space, triangles, points, weights[:, None] * _values(force, points))


def point_load(space: Space, points: ArrayLike, forces: ArrayLike) -> Floats:
    """(N, 3) N, dead load of forces (n, 3) N at printed points (n, 2) mm."""
    at = np.atleast_2d(np.asarray(points, dtype=float))
    return np.asarray(space.locate(at).spread(np.broadcast_to(np.asarray(forces, dtype=float), (len(at), 3))))


def edge_points(space: Space, facets: Ints) -> tuple[Ints, Floats, Floats]:
    """Gauss points of mesh edges, exact for the space: triangles (n,), printed points (n, 2) and weights (n,) in mm."""
    roots, shares = np.polynomial.legendre.leggauss(space.degree + 1)
    a, b = space.mesh.p.T[space.mesh.facets[:, facets]]
    points = a[:, None] + 0.5 * (roots[:, None] + 1.0) * (b - a)[:, None]
    weights = 0.5 * shares * np.linalg.norm(b - a, axis=1)[:, None]
    triangles = np.repeat(space.mesh.f2t[0, facets], len(roots))
    return triangles, points.reshape(-1, 2), weights.ravel()


def _gather(space: Space, triangles: Ints, points: Floats, forces: Floats) -> Floats:
    dofs, jets = space.jets(triangles, points)
    loads = np.zeros((space.size, 3))
    np.add.at(loads, dofs, jets[..., 0][..., None] * forces[:, None])
    return loads


def _values(force: Force, points: Floats) -> Floats:
    values = force(points) if callable(force) else force
    return np.broadcast_to(np.asarray(values, dtype=float), (len(points), 3))
