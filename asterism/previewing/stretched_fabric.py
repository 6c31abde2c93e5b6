"""What bare fabric does when it is stretched to twice its length and more, as it is beside a pin.

The law's energy is quadratic in Green's strain: good for a few tens of percent, and far too stiff beyond. The exact
model's fabric is neo-Hookean (`discrete.membrane`), per rest area

    W = mu/2 (tr C - 2 - 2 ln J) + lam/2 (ln J)^2,    C = 1 + 2 E/lambda^2,    J^2 = det C,

E being the strain in printed coordinates from the rest metric lambda^2. The difference of W and its quadratic part is
added to the shell's energy, times the share of bare fabric.
"""

from __future__ import annotations

import numpy as np

from fem.density import Law
from fem.fields import Fields
from fem.tabulation import Floats

# det C below which ln J goes on as a parabola: strains on their way to an equilibrium may be no strains of a surface
LEAST = 0.1


def stretched_fabric(fields: Fields, stiffness: Floats, bare: Floats) -> Law:
    """The further law of a density with a stiffness (T, Q, 6, 6), bare (T, Q) of it being fabric.

    Young's modulus and Poisson's ratio are those of the stiffness, so that it stays what it is for small strains.
    """
    metric = np.asarray(fields.metric, dtype=float).reshape(-1, 3)
    square = 0.5 * (metric[:, 0] + metric[:, 1])
    membrane, share = stiffness[..., :3, :3].reshape(-1, 3, 3), bare.ravel()
    poisson = membrane[:, 0, 1] / membrane[:, 0, 0]
    plane = membrane[:, 0, 0] * square**2
    mu, lam = 0.5 * (1.0 - poisson) * plane, poisson * plane
    small = plane[:, None, None] * np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    small[:, 0, 1] = small[:, 1, 0] = lam
    small[:, 2, 2] = mu

    def law(e: Floats) -> tuple[Floats, Floats, Floats]:
        strain = e[:, :3] / square[:, None]
        c11, c22, c12 = 1.0 + 2.0 * strain[:, 0], 1.0 + 2.0 * strain[:, 1], strain[:, 2]
        det = c11 * c22 - c12**2
        log, first, second = _half_log(det)
        slope = lam * log - mu  # of W by ln J
        stress = np.matmul(small, strain[..., None])[..., 0]
        energy = 0.5 * mu * (c11 + c22 - 2.0) - mu * log + 0.5 * lam * log**2 - 0.5 * (stress * strain).sum(axis=1)
        turn = np.column_stack([2.0 * c22, 2.0 * c11, -2.0 * c12])  # of det C by the strain
        gradient, hessian = np.zeros((len(e), 6)), np.zeros((len(e), 6, 6))
        gradient[:, :3] = (slope * first)[:, None] * turn - stress
        gradient[:, :2] += mu[:, None]
        rate = lam * first**2 + slope * second
        hessian[:, :3, :3] = rate[:, None, None] * turn[:, :, None] * turn[:, None] - small
        bend = 4.0 * slope * first
        hessian[:, 0, 1] += bend
        hessian[:, 1, 0] += bend
        hessian[:, 2, 2] -= 0.5 * bend
        one, two = share / square, share / square**2
        return share * energy, one[:, None] * gradient, two[:, None, None] * hessian

    return law


def _half_log(det: Floats) -> tuple[Floats, Floats, Floats]:
    """`ln(det)/2` with its first and second derivative."""
    at = np.maximum(det, LEAST)
    by = (det - at) / at
    return 0.5 * (np.log(at) + by - 0.5 * by**2), 0.5 * (1.0 - by) / at, -0.5 / at**2
