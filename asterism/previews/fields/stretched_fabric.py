"""Neo-Hookean energy of bare fabric at large strains, as beside a pin.

The law's energy is quadratic in Green's strain. It is accurate up to strains of a few tens of percent, and far too
stiff beyond. The fabric of the exact model is neo-Hookean (`discrete.energies.membrane`), with the energy per rest area

    W = mu/2 (tr C - 2 - 2 ln J) + lam/2 (ln J)^2,    C = 1 + 2 E/lambda^2,    J^2 = det C,

where E is the strain in printed coordinates from the rest metric lambda^2. The shell's energy gets the difference
between W and its quadratic part, times the share of bare fabric. If the rest metric follows the curvature
(`asterism.previews.fields.sheet_fields`), E is measured from that metric: W grows more slowly than a quadratic energy,
and together with a quadratic coupling it would have no lower bound.
"""

from __future__ import annotations

import numpy as np

from equilibrium.arrays import Floats
from equilibrium.compiled import formula, loop
from fem.shell.density import EnergyTerm
from fem.shell.fields import Fields

# below this det C, ln J continues as a parabola: during a search, strains may be impossible for a surface
MIN_DET_C = 0.1


def stretched_fabric(fields: Fields, stiffness: Floats, bare: Floats) -> EnergyTerm:
    """Additional energy term of a shell with stiffness (T, Q, 6, 6) and share (T, Q) of bare fabric.

    Young's modulus and Poisson's ratio follow from the stiffness, so that small strains have the same energy as before.
    """
    metric = np.asarray(fields.metric, dtype=float).reshape(-1, 3)
    square = 0.5 * (metric[:, 0] + metric[:, 1])
    membrane = stiffness[..., :3, :3].reshape(-1, 3, 3)
    # strains are measured from the rest metric at the current curvature
    follows = np.empty_like(membrane)
    _solve_symmetric(membrane, stiffness[..., :3, 3:].reshape(-1, 3, 3), follows)
    plane = bare.ravel() * membrane[:, 0, 0] * square**2
    lam = plane * membrane[:, 0, 1] / membrane[:, 0, 0]
    mu = 0.5 * (plane - lam)
    of_fabric = follows, bool(follows.any()), square, mu, lam

    def law(e: Floats) -> tuple[Floats, Floats, Floats]:
        energy, gradient, hessian = np.empty(len(e)), np.empty((len(e), 6)), np.empty((len(e), 6, 6))
        _beyond_quadratic(np.ascontiguousarray(e), *of_fabric, energy, gradient, hessian)
        return energy, gradient, hessian

    return law


@loop
def _solve_symmetric(matrix, right, out):  # type: ignore[no-untyped-def]
    """Set out (P, 3, 3) to the solutions of `matrix out = right`, for symmetric matrices (P, 3, 3), by cofactors."""
    for p in range(matrix.shape[0]):
        m = matrix[p]
        c00, c01 = m[1, 1] * m[2, 2] - m[1, 2] * m[1, 2], m[0, 2] * m[1, 2] - m[0, 1] * m[2, 2]
        c02, c11 = m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1], m[0, 0] * m[2, 2] - m[0, 2] * m[0, 2]
        c12, c22 = m[0, 1] * m[0, 2] - m[0, 0] * m[1, 2], m[0, 0] * m[1, 1] - m[0, 1] * m[0, 1]
        det = m[0, 0] * c00 + m[0, 1] * c01 + m[0, 2] * c02
        for k in range(3):
            a, b, c = right[p, 0, k] / det, right[p, 1, k] / det, right[p, 2, k] / det
            out[p, 0, k] = c00 * a + c01 * b + c02 * c
            out[p, 1, k] = c01 * a + c11 * b + c12 * c
            out[p, 2, k] = c02 * a + c12 * b + c22 * c


@loop
def _beyond_quadratic(e, follows, coupled, square, mu, lam, energy, gradient, hessian):  # type: ignore[no-untyped-def]
    """Set energy (P,), gradient and Hessian at strains e (P, 6).

    The membrane strains count from `follows` (P, 3, 3) times the bending strains, if they are coupled.
    """
    strain, turn, stress, both = np.empty(3), np.empty(3), np.empty(3), np.empty((3, 3))
    for p in range(e.shape[0]):
        for a in range(3):
            strain[a] = e[p, a]
            if coupled:
                strain[a] += follows[p, a, 0] * e[p, 3] + follows[p, a, 1] * e[p, 4] + follows[p, a, 2] * e[p, 5]
        e11, e22, shear = strain[0] / square[p], strain[1] / square[p], strain[2] / square[p]
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
        # a negative trace of C is impossible for a surface; it occurs if the rest metric follows the curvature
        inside_out = min(c11 + c22, 0.0)
        energy[p] += mu[p] * inside_out * inside_out
        for a in range(3):
            along = mu[p] * (1.0 + 4.0 * inside_out) if a < 2 else 0.0
            gradient[p, a] = (slope * first * turn[a] - stress[a] + along) / square[p]
            for b in range(3):
                value = rate * turn[a] * turn[b]
                if a < 2 and b < 2:
                    value += 8.0 * mu[p] if inside_out < 0.0 else 0.0
                    value -= lam[p]
                    value += -2.0 * mu[p] if a == b else 4.0 * slope * first
                if a == 2 and b == 2:
                    value -= mu[p] + 2.0 * slope * first
                hessian[p, a, b] = value / (square[p] * square[p])
        if coupled:
            _by_bending(follows[p], gradient[p], hessian[p], both)
        else:
            gradient[p, 3:] = 0.0
            hessian[p, :3, 3:] = hessian[p, 3:, :3] = hessian[p, 3:, 3:] = 0.0


@formula
def _by_bending(follows, gradient, hessian, both):  # type: ignore[no-untyped-def]
    """Set the derivatives by the bending strains from those by the membrane strains, by the chain rule."""
    for a in range(3):
        gradient[3 + a] = follows[0, a] * gradient[0] + follows[1, a] * gradient[1] + follows[2, a] * gradient[2]
        for b in range(3):
            value = 0.0
            for k in range(3):
                value += hessian[a, k] * follows[k, b]
            both[a, b] = hessian[a, 3 + b] = hessian[3 + b, a] = value
    for a in range(3):
        for b in range(3):
            value = 0.0
            for k in range(3):
                value += follows[k, a] * both[k, b]
            hessian[3 + a, 3 + b] = value
