"""Loads that no sheet of the product has, but the problems of published solutions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.elements.argyris import Argyris


def edge_load(space: Argyris, facets: Ints, force: ArrayLike) -> Floats:
    """(N, 3) N, dead load of a force (3,) N/mm per printed length of mesh edges (n,)."""
    roots, shares = np.polynomial.legendre.leggauss(6)
    a, b = space.mesh.p.T[space.mesh.facets[:, facets]]
    points = (a[:, None] + 0.5 * (roots[:, None] + 1.0) * (b - a)[:, None]).reshape(-1, 2)
    weights = (0.5 * shares * np.linalg.norm(b - a, axis=1)[:, None]).ravel()
    dofs, jets = space.jets(np.repeat(space.mesh.f2t[0, facets], len(roots)), points)
    loads = np.zeros((space.size, 3))
    np.add.at(loads, dofs, (weights[:, None] * jets[..., 0])[..., None] * np.asarray(force))
    return loads


def point_load(space: Argyris, points: ArrayLike, forces: ArrayLike) -> Floats:
    """(N, 3) N, dead load of forces (n, 3) N at printed points (n, 2) mm."""
    at = np.atleast_2d(np.asarray(points, dtype=float))
    return np.asarray(space.locate(at).value.T @ np.atleast_2d(forces))
