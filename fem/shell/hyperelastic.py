"""Hyperelastic fabric as a term of the shell's energy, for strains at which a quadratic energy is far too stiff.

The energy per released area is that of the exact model's fabric (`discrete.energies.membrane`),

    W = mu/2 [(C11^r1 - 1)/r1 + (C22^r2 - 1)/r2] - mu ln J + lam/2 (ln J)^2,    C = 1 + 2 E,    J^2 = det C,

with Green's strain E from the released fabric, along and across its grain. It is neo-Hookean for r1 = r2 = 1.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.compiled import loop

# below these, ln J and the powers continue as parabolas: during a search, strains may be impossible for a surface
MIN_DET_C = 0.1
MIN_C = 0.1


def hyperelastic(
    strain: Floats, mu: Floats, lam: Floats, exponents: tuple[float, float] = (1.0, 1.0)
) -> tuple[Floats, Floats, Floats]:
    """Energy per area (n,), gradient (n, 3) and Hessian (n, 3, 3) at strains E11, E22, 2 E12, (n, 3).

    Parameters
    ----------
    mu, lam : (n,) N/mm, moduli times thickness.
    exponents : r1 and r2.

    >>> (hyperelastic(np.zeros((1, 3)), np.ones(1), np.full(1, 0.5))[2][0] + 0.0).tolist()
    [[2.5, 0.5, 0.0], [0.5, 2.5, 0.0], [0.0, 0.0, 1.0]]
    """
    count = len(strain)
    energy, gradient, hessian = np.empty(count), np.empty((count, 3)), np.empty((count, 3, 3))
    _evaluate(np.ascontiguousarray(strain), mu, lam, np.array(exponents), energy, gradient, hessian)
    return energy, gradient, hessian


@loop
def _evaluate(strain, mu, lam, exponents, energy, gradient, hessian):  # type: ignore[no-untyped-def]
    turn = np.empty(3)
    for p in range(strain.shape[0]):
        c11, c22, shear = 1.0 + 2.0 * strain[p, 0], 1.0 + 2.0 * strain[p, 1], strain[p, 2]
        det = c11 * c22 - shear * shear
        at = max(det, MIN_DET_C)
        by = (det - at) / at
        log = 0.5 * (np.log(at) + by - 0.5 * by * by)  # ln J, and its derivatives by det C
        first, second = 0.5 * (1.0 - by) / at, -0.5 / (at * at)
        slope = lam[p] * log - mu[p]  # of W by ln J
        rate = lam[p] * first * first + slope * second
        turn[0], turn[1], turn[2] = 2.0 * c22, 2.0 * c11, -2.0 * shear  # of det C by the strain
        energy[p] = 0.5 * lam[p] * log * log - mu[p] * log
        for a in range(3):
            gradient[p, a] = slope * first * turn[a]
            for b in range(3):
                hessian[p, a, b] = rate * turn[a] * turn[b]
        for a in range(2):
            r, c = exponents[a], 1.0 + 2.0 * strain[p, a]
            at = max(c, MIN_C)
            power, by = at**r, (c - at) / at
            energy[p] += 0.5 * mu[p] * ((power - 1.0) / r + power * (by + 0.5 * (r - 1.0) * by * by))
            gradient[p, a] += mu[p] * power / at * (1.0 + (r - 1.0) * by)
            hessian[p, a, a] += 2.0 * mu[p] * power / (at * at) * (r - 1.0)
        hessian[p, 0, 1] += 4.0 * slope * first
        hessian[p, 1, 0] += 4.0 * slope * first
        hessian[p, 2, 2] -= 2.0 * slope * first
