"""Neo-Hookean energy of bare fabric beside a motif, at the strains of its tension.

Bare fabric that rods hold is stretched by a third of its length and more. Where it forms a rim, its tension bends the
whole sheet: along the rim the fabric pulls, and the rods beside it resist. The energy per printed area is that of the
exact model's fabric (`discrete.energies.membrane`),

    W = V [mu/2 (tr C - 2 - 2 ln J) + lam/2 (ln J)^2],    C = 1 + 2 E,    J^2 = det C,

with the volume V of fabric per printed area and the strain E from the released fabric.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.shell.density import EnergyTerm
from asterism.pattern.design.materials import Fabric

# below this det C, ln J continues as a parabola: during a search, strains may be impossible for a surface
MIN_DET_C = 0.1


def bare_fabric(fabric: Fabric, metric: Floats, share: Floats) -> EnergyTerm:
    """Additional energy term of a shell whose strains count from a rest metric.

    Parameters
    ----------
    metric : (T, Q, 3) rest metric of the shell.
    share : (T, Q) of bare fabric.
    """
    released = np.array([1.0 / stretch**2 for stretch in fabric.stretch_xy])
    reference = metric.reshape(-1, 3)
    already = np.stack(
        [0.5 * (reference[:, 0] - released[0]), 0.5 * (reference[:, 1] - released[1]), reference[:, 2]], axis=1
    )
    # of strains E11, E22, 2 E12 in the released fabric's own lengths
    scale = 1.0 / np.array([released[0], released[1], np.sqrt(released.prod())])
    amount = share.ravel() * fabric.thickness_mm * np.sqrt(released.prod())
    mu = fabric.modulus_mpa / (2.0 * (1.0 + fabric.poisson))
    lam = fabric.modulus_mpa * fabric.poisson / (1.0 - fabric.poisson**2)
    where = np.flatnonzero(amount)

    def term(e: Floats) -> tuple[Floats, Floats, Floats]:
        energy, gradient, hessian = np.zeros(len(e)), np.zeros((len(e), 6)), np.zeros((len(e), 6, 6))
        value, slope, curve = neo_hookean((e[where, :3] + already[where]) * scale, mu, lam)
        energy[where] = amount[where] * value
        gradient[where, :3] = amount[where, None] * scale * slope
        hessian[where, :3, :3] = amount[where, None, None] * np.outer(scale, scale) * curve
        return energy, gradient, hessian

    return term


def fabric_tension(fabric: Fabric, metric: Floats) -> Floats:
    """(..., 3) N/mm, tension 11, 22, 12 in printed coordinates of fabric on a metric (..., 3)."""
    places = metric.reshape(1, -1, 3)
    term = bare_fabric(fabric, places, np.ones(places.shape[:2]))
    return term(np.zeros((places.shape[1], 6)))[1][:, :3].reshape(metric.shape)


def neo_hookean(strain: Floats, mu: float, lam: float) -> tuple[Floats, Floats, Floats]:
    """Energy per area (n,), gradient (n, 3) and Hessian (n, 3, 3) at Green's strains E11, E22, 2 E12, (n, 3).

    Examples
    --------
    >>> (neo_hookean(np.zeros((1, 3)), 1.0, 0.5)[2][0] + 0.0).tolist()
    [[2.5, 0.5, 0.0], [0.5, 2.5, 0.0], [0.0, 0.0, 1.0]]
    """
    c11, c22, shear = 1.0 + 2.0 * strain[:, 0], 1.0 + 2.0 * strain[:, 1], strain[:, 2]
    det = c11 * c22 - shear**2
    at = np.maximum(det, MIN_DET_C)
    by = (det - at) / at
    log = 0.5 * (np.log(at) + by - 0.5 * by**2)
    first, second = 0.5 * (1.0 - by) / at, -0.5 / at**2  # of ln J by det C
    force, rate = lam * log - mu, lam * first**2 + (lam * log - mu) * second
    turn = np.stack([2.0 * c22, 2.0 * c11, -2.0 * shear], axis=1)
    bend = np.array([[0.0, 4.0, 0.0], [4.0, 0.0, 0.0], [0.0, 0.0, -2.0]])
    energy = mu * (0.5 * (c11 + c22) - 1.0 - log) + 0.5 * lam * log**2
    gradient = (force * first)[:, None] * turn + mu * np.array([1.0, 1.0, 0.0])
    hessian = rate[:, None, None] * turn[:, :, None] * turn[:, None, :] + (force * first)[:, None, None] * bend
    return energy, gradient, hessian
