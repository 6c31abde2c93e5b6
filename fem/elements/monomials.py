"""Monomials of two variables, and their derivatives up to the second."""

from __future__ import annotations

from functools import cache

import numpy as np

from equilibrium.compiled import loop
from fem.elements.tabulation import Floats, Ints


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
def polynomials(exponents, factors, scale, pieces, points, out):  # type: ignore[no-untyped-def]
    """Write values and derivatives 1, 2, 11, 22, 12 of c piecewise polynomials at points (n, 2) to out (n, 6, c).

    `pieces` (n,) are the pieces of the points, `factors` (T, k, c) the coefficients of a piece, and `scale` (T,) its
    unit of length; points are in this unit.
    """
    top = exponents.max()
    ladder = np.ones((2, top + 1))
    row = np.empty(6)
    for p in range(points.shape[0]):
        coefficients, unit = factors[pieces[p]], 1.0 / scale[pieces[p]]
        for power in range(1, top + 1):
            for a in range(2):
                ladder[a, power] = ladder[a, power - 1] * points[p, a]
        out[p] = 0.0
        for k in range(exponents.shape[0]):
            i, j = exponents[k, 0], exponents[k, 1]
            u, v = ladder[0, i], ladder[1, j]
            du, dv = i * ladder[0, max(i - 1, 0)] * unit, j * ladder[1, max(j - 1, 0)] * unit
            ddu = i * (i - 1) * ladder[0, max(i - 2, 0)] * unit * unit
            ddv = j * (j - 1) * ladder[1, max(j - 2, 0)] * unit * unit
            row[0], row[1], row[2], row[3], row[4], row[5] = u * v, du * v, u * dv, ddu * v, u * ddv, du * dv
            for a in range(6):
                for c in range(coefficients.shape[1]):
                    out[p, a, c] += row[a] * coefficients[k, c]
