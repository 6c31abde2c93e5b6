"""Tensile part of a membrane stress, whose geometric stiffness is positive semidefinite."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats


def tensile_part(stress: Floats) -> Floats:
    """(..., 6) stress with the positive parts of the principal membrane stresses, and without moments.

    Examples
    --------
    Pure shear is tension and compression at 45 degrees; the tension remains:

    >>> tensile_part(np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0]))
    array([0.5, 0.5, 0.5, 0. , 0. , 0. ])
    """
    mean = 0.5 * (stress[..., 0] + stress[..., 1])
    radius = np.hypot(0.5 * (stress[..., 0] - stress[..., 1]), stress[..., 2])
    high, low = mean + radius, mean - radius
    # the result is p I + q S; q = 1 if both principal stresses are positive, 0 if both are negative
    share = np.where(low >= 0.0, 1.0, np.where(high <= 0.0, 0.0, high / np.maximum(high - low, 1e-300)))
    lift = np.where((low < 0.0) & (high > 0.0), -low * share, 0.0)
    out = np.zeros_like(stress)
    out[..., :3] = share[..., None] * stress[..., :3]
    out[..., :2] += lift[..., None]
    return out
