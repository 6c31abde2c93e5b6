"""Neo-Hookean energy of bare fabric at large strains, as beside a pin.

The law's energy is quadratic in Green's strain. It is accurate up to strains of a few tens of percent, and far too
stiff beyond. The fabric of the exact model is neo-Hookean (`discrete.energies.membrane`), with the energy per rest area

    W = mu/2 (tr C - 2 - 2 ln J) + lam/2 (ln J)^2,    C = 1 + 2 E/lambda^2,    J^2 = det C,

where E is the strain in printed coordinates from the rest metric lambda^2. The shell's energy gets the difference
between W and its quadratic part, times the share of bare fabric. Only supports stretch fabric this far. In supported
sheets the rest metric does not follow the curvature, so that W depends on the metric alone.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.compiled import loop
from asterism.fem.shell.density import EnergyTerm
from asterism.fem.shell.fields import Fields

# below this det C, ln J continues as a parabola: during a search, strains may be impossible for a surface
MIN_DET_C = 0.1


def stretched_fabric(fields: Fields, stiffness: Floats, bare: Floats) -> EnergyTerm:
    """Additional energy term of a shell with stiffness (T, Q, 6, 6) and share (T, Q) of bare fabric.

    Young's modulus and Poisson's ratio follow from the stiffness, so that small strains have the same energy as before.
    """
    metric = np.asarray(fields.metric, dtype=float).reshape(-1, 3)
    square = 0.5 * (metric[:, 0] + metric[:, 1])
    membrane = stiffness[..., :3, :3].reshape(-1, 3, 3)
    plane = bare.ravel() * membrane[:, 0, 0] * square**2
    lam = plane * membrane[:, 0, 1] / membrane[:, 0, 0]
    mu = 0.5 * (plane - lam)

    def law(e: Floats) -> tuple[Floats, Floats, Floats]:
        energy, gradient, hessian = np.empty(len(e)), np.empty((len(e), 6)), np.empty((len(e), 6, 6))
        _beyond_quadratic(np.ascontiguousarray(e), square, mu, lam, energy, gradient, hessian)
        return energy, gradient, hessian

    return law


@loop
def _beyond_quadratic(e, square, mu, lam, energy, gradient, hessian):  # type: ignore[no-untyped-def]
    """Set energy (P,), gradient and Hessian at strains e (P, 6), of which the last three are bending strains."""
    turn, stress = np.empty(3), np.empty(3)
    for p in range(e.shape[0]):
        e11, e22, shear = e[p, 0] / square[p], e[p, 1] / square[p], e[p, 2] / square[p]
        c11, c22 = 1.0 + 2.0 * e11, 1.0 + 2.0 * e22
        det = c11 * c22 - shear * shear
        at = max(det, MIN_DET_C)
        by = (det - at) / at
        log = 0.5 * (np.log(at) + by - 0.5 * by * by)  # ln J, and its derivatives by det C
        first, second = 0.5 * (1.0 - by) / at, -0.5 / (at * at)
        slope = lam[p] * log - mu[p]  # of W by ln J
        rate = lam[p] * first * first + slope * second
        turn[0], turn[1], turn[2] = 2.0 * c22, 2.0 * c11, -2.0 * shear  # of det C by the strain
        stress[0] = 2.0 * mu[p] * e11 + lam[p] * (e11 + e22)
        stress[1] = 2.0 * mu[p] * e22 + lam[p] * (e11 + e22)
        stress[2] = mu[p] * shear
        energy[p] = mu[p] * (e11 + e22 - log) + 0.5 * lam[p] * log * log
        energy[p] -= 0.5 * (stress[0] * e11 + stress[1] * e22 + stress[2] * shear)
        for a in range(3):
            along = mu[p] if a < 2 else 0.0
            gradient[p, a] = (slope * first * turn[a] - stress[a] + along) / square[p]
            for b in range(3):
                value = rate * turn[a] * turn[b]
                if a < 2 and b < 2:
                    value -= lam[p]
                    value += -2.0 * mu[p] if a == b else 4.0 * slope * first
                if a == 2 and b == 2:
                    value -= mu[p] + 2.0 * slope * first
                hessian[p, a, b] = value / (square[p] * square[p])
        gradient[p, 3:] = 0.0
        hessian[p, :3, 3:] = hessian[p, 3:, :3] = hessian[p, 3:, 3:] = 0.0
