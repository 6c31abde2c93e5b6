"""Compliance of the sheet around a pin at a single point.

The displacement of a membrane that is pulled at a point depends on the logarithm of the size of the loaded spot, and
diverges if that size goes to zero. In the exact model, the spot is a fraction of the edge h of the triangles. The edges
L of the shell are about twenty times longer, so that its spot is larger and its displacement smaller. A softer region
around the pin compensates for this: there, the membrane stiffness is divided by `1 + A exp(-r^2/(p L)^2)`.

The amplitude A follows from a wedge of angle alpha under a force F at its tip, fixed at the distance R (Michell 1900;
E t is Young's modulus times thickness). Its tip moves by u:

    exact     u K / F = ln(R/h) + c(alpha),                      K = E t (alpha + sin alpha)/2
    shell     u K / F = ln(R/L) + d(alpha) + A g(alpha)

Both models give the same u for `A = (ln(L/h) - (d - c))/g`. d - c and g are computed from wedges in both models.

**Bare fabric at large strains**, as beside a pin. The law's energy is quadratic in Green's strain. It is accurate up to
strains of a few tens of percent, and far too stiff beyond. The fabric of the exact model is neo-Hookean
(`fem.shell.hyperelastic`). The energy of the shell gets the difference between that energy W and its quadratic part,
times the share of bare fabric; strains count from the rest metric lambda^2. Only supports stretch fabric this far. In
supported sheets the rest metric does not follow the curvature, so that W depends on the metric alone.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.fem.shell.density import Density, EnergyTerm
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.hyperelastic import hyperelastic
from asterism.homogenize.law.anisotropy import isotropic_constants
from asterism.pattern.geometry.planar import triangle_angles
from asterism.pattern.mesh.sheet_mesh import SheetMesh


def stretched_fabric(fields: Fields, stiffness: Floats, bare: Floats) -> EnergyTerm:
    """Additional energy term of a shell with stiffness (T, Q, 6, 6) and share (T, Q) of bare fabric.

    Young's modulus and Poisson's ratio follow from the stiffness, so that small strains have the same energy as before.
    If that differs by direction, they are those of the stiffest isotropic fabric that is nowhere stiffer: the sheet
    would have no minimum otherwise.
    """
    metric = np.asarray(fields.metric, dtype=float).reshape(-1, 3)
    square = 0.5 * (metric[:, 0] + metric[:, 1])
    membrane = stiffness[..., :3, :3].reshape(-1, 3, 3)
    a11, a12 = isotropic_constants(membrane)
    modes = np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 0.0, 2.0]]) / np.sqrt(2.0)
    own = np.stack([a11 + a12, a11 - a12, a11 - a12], axis=-1) ** -0.5
    over = own[:, :, None] * (modes @ membrane @ modes.T) * own[:, None, :]
    plane = bare.ravel() * np.linalg.eigvalsh(over)[:, 0] * a11 * square**2
    lam = plane * a12 / a11
    mu = 0.5 * (plane - lam)

    quadratic = np.zeros((len(mu), 3, 3))
    quadratic[:, :2, :2] = lam[:, None, None]
    quadratic[:, [0, 1], [0, 1]] += 2.0 * mu[:, None]
    quadratic[:, 2, 2] = mu

    def beyond(e: Floats) -> tuple[Floats, Floats, Floats]:
        strain, gradient, hessian = e[:, :3] / square[:, None], np.zeros((len(e), 6)), np.zeros((len(e), 6, 6))
        energy, slope, curve = hyperelastic(strain, mu, lam)
        linear = np.einsum("pab,pb->pa", quadratic, strain)
        gradient[:, :3] = (slope - linear) / square[:, None]
        hessian[:, :3, :3] = (curve - quadratic) / (square**2)[:, None, None]
        return energy - 0.5 * np.einsum("pa,pa->p", strain, linear), gradient, hessian

    return beyond


# angles of the sheet at a pin in degrees; there, what the shell's vertex lacks in compliance, d - c, and the compliance
# that a softness of one adds, g: from wedges of bare fabric, as in pytest tests/asterism/previews/test_point_pins.py
ANGLES_DEG = (45.0, 60.0, 90.0, 120.0, 150.0, 180.0, 270.0, 360.0)
LACK = (2.90, 2.81, 2.53, 1.71, 1.48, 1.38, 0.97, 0.86)
GAIN = (2.82, 2.67, 2.30, 1.49, 1.14, 0.93, 0.59, 0.74)
# lower limit of the softness: the region around a pin is at most twice as stiff as the sheet
MIN_SOFTNESS = -0.5


def softness(mesh: SheetMesh, pins: Floats, points: Floats, edge_mm: float) -> Floats:
    """(...,) softness s at printed points (..., 2) mm: the membrane stiffness is divided by 1 + s.

    `mesh` is the shell's, `pins` (n, 2) mm are vertices of it, and `edge_mm` is the edge length h of the exact model.
    """
    edges, angles = around(mesh, pins)
    amounts = amounts_of(edges, angles, edge_mm)
    total = np.zeros(points.shape[:-1])
    for pin, edge, amount in zip(pins, edges, amounts, strict=True):
        total += amount * spot(pin, edge, points)
    return np.maximum(total, MIN_SOFTNESS)


def spot(pin: Floats, edge_mm: float, points: Floats) -> Floats:
    """(...,) the Gaussian `exp(-r^2/(p L)^2)` at points (..., 2) mm around a pin (2,), with L = `edge_mm`, p = 0.35."""
    return np.asarray(np.exp(-((points - pin) ** 2).sum(axis=-1) / (0.35 * edge_mm) ** 2))


def amounts_of(edges: Floats, angles_deg: Floats, edge_mm: float) -> Floats:
    """(n,) amplitudes A at pins, edges L (n,) mm, angles (n,) of the sheet; negative if h = `edge_mm` is long."""
    lack, gain = (np.interp(angles_deg, ANGLES_DEG, of) for of in (LACK, GAIN))
    return np.maximum((np.log(edges / edge_mm) - lack) / gain, MIN_SOFTNESS)


def around(mesh: SheetMesh, pins: Floats) -> tuple[Floats, Floats]:
    """(n,) geometric mean of the edge lengths at pins (n, 2), in mm, and (n,) angle of the sheet there, in deg."""
    corner_deg = triangle_angles(mesh.points, mesh.triangles)
    edges, angles = np.empty(len(pins)), np.empty(len(pins))
    for k, pin in enumerate(pins):
        vertex = int(((mesh.points - pin) ** 2).sum(axis=1).argmin())
        at: Ints = mesh.triangles == vertex
        neighbours = np.setdiff1d(mesh.triangles[at.any(axis=1)], [vertex])
        edges[k] = np.exp(np.log(np.linalg.norm(mesh.points[neighbours] - pin, axis=1)).mean())
        angles[k] = corner_deg[at].sum()
    return edges, angles


def softened(fields: Fields, soft: Floats | None) -> Fields:
    """The fields with the membrane stiffness divided by 1 + s, for a softness s (T, Q), from `softness`."""
    if soft is None:
        return fields
    assert isinstance(fields.density, Density)
    stiffness = np.array(fields.density.stiffness)
    stiffness[..., :3, :3] /= (1.0 + soft)[..., None, None]
    return replace(fields, density=replace(fields.density, stiffness=stiffness))
