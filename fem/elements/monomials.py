"""Monomials of two variables up to degree 5, and their derivatives up to the second."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop

DEGREE = 5
# exponents (21, 2) of all monomials: degree by degree, the first one rising
POWERS: Ints = np.array([(i, n - i) for n in range(DEGREE + 1) for i in range(n + 1)])
# order of the derivatives 0, 1, 2, 11, 22, 12 by the first and by the second variable
_BY = np.array([(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1)])
# (21, 6, 2) exponents of the derivatives; -1 and -2 belong to derivatives that are zero
_LEFT = POWERS[:, None] - _BY
# (21, 6) factors of the derivatives
_FACTORS = np.prod([np.where(k < _BY, POWERS[:, None] - k, 1) for k in (0, 1)], axis=(0, -1)).astype(float)


def monomials(points: Floats) -> Floats:
    """(n, 21, 6) values and derivatives 1, 2, 11, 22, 12 of the monomials at points (n, 2)."""
    ladder = np.ones((2, len(points), DEGREE + 1))
    for power in range(1, DEGREE + 1):
        ladder[:, :, power] = ladder[:, :, power - 1] * points.T
    first, second = np.moveaxis(np.maximum(_LEFT, 0), -1, 0)
    return np.asarray(_FACTORS * ladder[0].take(first, axis=1) * ladder[1].take(second, axis=1))


@loop
def polynomials(factors, scale, pieces, points, out):  # type: ignore[no-untyped-def]
    """Write values and derivatives 1, 2, 11, 22, 12 of c piecewise polynomials at points (n, 2) to out (n, 6, c).

    `pieces` (n,) are the pieces of the points, `factors` (T, k, c) the coefficients of a piece in the order of
    `POWERS`, and `scale` (T,) its unit of length; points are in this unit. Horner's scheme, first along the
    second coordinate and then along the first one.
    """
    for p in range(points.shape[0]):
        coefficients, unit = factors[pieces[p]], 1.0 / scale[pieces[p]]
        square = unit * unit
        u, v = points[p]
        for c in range(coefficients.shape[1]):
            f = f1 = f11 = f2 = f12 = f22 = 0.0  # of second derivatives in the same coordinate the half
            for i in range(DEGREE, -1, -1):
                q = q2 = q22 = 0.0
                for n in range(DEGREE, i - 1, -1):
                    q22 = q22 * v + q2
                    q2 = q2 * v + q
                    q = q * v + coefficients[n * (n + 1) // 2 + i, c]
                f11 = f11 * u + f1
                f1 = f1 * u + f
                f = f * u + q
                f12 = f12 * u + f2
                f2 = f2 * u + q2
                f22 = f22 * u + q22
            out[p, 0, c], out[p, 1, c], out[p, 2, c] = f, f1 * unit, f2 * unit
            out[p, 3, c], out[p, 4, c], out[p, 5, c] = 2.0 * f11 * square, 2.0 * f22 * square, f12 * square
