"""Monomials of two variables, and their derivatives up to the second."""

from __future__ import annotations

from functools import cache

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop


def powers(degree: int) -> Ints:
    """(k, 2) exponents of all monomials up to a degree.

    Examples
    --------
    >>> powers(1).tolist()
    [[0, 0], [0, 1], [1, 0]]
    """
    return np.array([(i, n - i) for n in range(degree + 1) for i in range(n + 1)])


def monomials(exponents: Ints, points: Floats) -> Floats:
    """(n, k, 6) values and derivatives 1, 2, 11, 22, 12 of monomials with exponents (k, 2) at points (n, 2)."""
    top = int(exponents.max())
    ladder = np.ones((2, len(points), top + 1))
    for power in range(1, top + 1):
        ladder[:, :, power] = ladder[:, :, power - 1] * points.T
    factors, first, second = _derivatives(exponents.tobytes(), len(exponents), exponents.dtype.str)
    return np.asarray(factors * ladder[0].take(first, axis=1) * ladder[1].take(second, axis=1))


@cache
def _derivatives(exponents: bytes, count: int, kind: str) -> tuple[Floats, Ints, Ints]:
    """Factors (k, 6) of the derivatives, and the remaining exponents (k, 6) of both variables."""
    a, b = np.frombuffer(exponents, dtype=kind).reshape(count, 2).T[:, :, None]
    i, j = np.array([(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1)]).T
    factors = np.ones((count, 6))
    for power, order in ((a, i), (b, j)):
        for k in (0, 1):
            factors *= np.where(order > k, power - k, 1)
    return np.where((a >= i) & (b >= j), factors, 0.0), np.maximum(a - i, 0), np.maximum(b - j, 0)


@loop
def polynomials(degree, factors, scale, pieces, points, out):  # type: ignore[no-untyped-def]
    """Write values and derivatives 1, 2, 11, 22, 12 of c piecewise polynomials at points (n, 2) to out (n, 6, c).

    `pieces` (n,) are the pieces of the points, `factors` (T, k, c) the coefficients of a piece in the order of
    `powers(degree)`, and `scale` (T,) its unit of length; points are in this unit. Horner's scheme, first along the
    second coordinate and then along the first one.
    """
    for p in range(points.shape[0]):
        coefficients, unit = factors[pieces[p]], 1.0 / scale[pieces[p]]
        square = unit * unit
        u, v = points[p]
        for c in range(coefficients.shape[1]):
            f = f1 = f11 = f2 = f12 = f22 = 0.0  # of second derivatives in the same coordinate the half
            for i in range(degree, -1, -1):
                q = q2 = q22 = 0.0
                for n in range(degree, i - 1, -1):
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
