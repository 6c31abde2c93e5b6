"""Torsional stiffness of a rectangular cross-section."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Array


def torsion_constant(width: Array, thickness: Array) -> Array:
    """Saint-Venant's torsion constant J of rectangles.

    Parameters
    ----------
    width, thickness : (...) mm, in any order.

    Returns
    -------
    (...) mm^4. The series of Timoshenko and Goodier, Theory of Elasticity, section 109, up to terms below 1e-9.

    Examples
    --------
    The square has J = 0.1406 a^4, a thin strip nearly a b^3/3:

    >>> torsion_constant(np.array([1.0, 100.0]), np.array([1.0, 1.0])).round(4)
    array([ 0.1406, 33.1233])
    """
    a, b = np.maximum(width, thickness), np.minimum(width, thickness)
    n = np.arange(1, 200, 2).reshape(-1, *([1] * np.ndim(a)))
    series = (np.tanh(n * np.pi * a / (2.0 * b)) / n**5).sum(axis=0)
    return np.asarray(a * b**3 * (1.0 / 3.0 - 64.0 / np.pi**5 * (b / a) * series))
