"""Stiffness of a rectangular cross-section."""

from __future__ import annotations

import numpy as np

from discrete.energies.elements import Array


def torsion_constant(width: Array, thickness: Array) -> Array:
    """Saint-Venant torsion constant J (mm^4) of rectangles (mm).

    Exact series (Timoshenko and Goodier, Theory of Elasticity, section 109), cut where its terms fall below 1e-9.
    """
    a, b = np.maximum(width, thickness), np.minimum(width, thickness)
    n = np.arange(1, 200, 2).reshape(-1, *([1] * np.ndim(a)))
    series = (np.tanh(n * np.pi * a / (2.0 * b)) / n**5).sum(axis=0)
    return np.asarray(a * b**3 * (1.0 / 3.0 - 64.0 / np.pi**5 * (b / a) * series))
