"""A hexagonal sheet with fields of a roll, a dome and a saddle."""

from __future__ import annotations

import numpy as np
from skfem import MeshTri

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import Density, isotropic
from asterism.fem.shell.fields import Fields, of_stretch

RADIUS, THICKNESS, MODULUS, POISSON = 130.0, 2.6, 7.0, 0.3  # mm, mm, MPa


def hexagon(refinements: int) -> MeshTri:
    """6, 24, 96... triangles, corners on the first axis."""
    corners = [(np.cos(a), np.sin(a)) for a in np.arange(6) * np.pi / 3]
    mesh = MeshTri(np.array([(0.0, 0.0), *corners]).T, np.array([(0, i, i % 6 + 1) for i in range(1, 7)]).T)
    mesh = mesh.refined(refinements)
    return MeshTri(RADIUS * mesh.p, mesh.t)


def density(sixfold: float = 0.0) -> Density:
    """An isotropic sheet; `sixfold` in N mm^2 gives it six preferred axes."""
    plate = THICKNESS**3 / 12.0
    stiffness = isotropic(*(MODULUS / (1.0 - POISSON**2) * np.array([THICKNESS, plate])), POISSON)
    return Density(stiffness, sixfold, saturation=0.02 if sixfold else np.inf)


def radius(points: Floats) -> Floats:
    """(...,) distances from the centre, 1 at the corners."""
    return np.linalg.norm(points, axis=-1) / RADIUS


FIELDS: dict[str, Fields] = {
    "rolled": of_stretch(density(100.0), 0.8, 0.015),
    "rolled about any axis": of_stretch(density(), 0.8, 0.015),
    "bowl": of_stretch(density(), 0.8, 0.001),
    "dome": of_stretch(density(), lambda p: 0.85 - 0.1 * radius(p) ** 2, 0.004),
    "saddle": of_stretch(density(), lambda p: 0.75 + 0.1 * radius(p) ** 2, 0.004),
    "curls on one side": of_stretch(density(), 0.8, lambda p: 0.006 + 0.006 * p[..., 0] / RADIUS),
}
