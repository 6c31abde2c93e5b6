"""Monomials of two variables and their derivatives up to the second."""

from __future__ import annotations

import numpy as np

from fem.tabulation import Floats, Ints


def powers(degree: int) -> Ints:
    """(k, 2) exponents of all monomials up to a degree."""
    return np.array([(i, n - i) for n in range(degree + 1) for i in range(n + 1)])


def monomials(exponents: Ints, points: Floats) -> Floats:
    """(n, k, 6) values and derivatives 1, 2, 11, 22, 12 at points (n, 2)."""
    top = int(exponents.max())
    ladder = np.ones((2, len(points), top + 1))
    for power in range(1, top + 1):
        ladder[:, :, power] = ladder[:, :, power - 1] * points.T
    table = np.empty((len(points), len(exponents), 6))
    for column, (i, j) in enumerate([(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1)]):
        a, b = exponents[:, 0], exponents[:, 1]
        factor = np.where((a >= i) & (b >= j), _falling(a, i) * _falling(b, j), 0)
        table[..., column] = factor * ladder[0][:, np.maximum(a - i, 0)] * ladder[1][:, np.maximum(b - j, 0)]
    return table


def _falling(n: Ints, k: int) -> Ints:
    """n (n-1) ... down to k factors."""
    return np.ones_like(n) if k == 0 else n * _falling(n - 1, k - 1)
