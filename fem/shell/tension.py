"""Tensile part of a membrane stress, whose geometric stiffness is positive semidefinite."""

from __future__ import annotations

import numpy as np

from fem.elements.tabulation import Floats


def tensile_part(stress: Floats) -> Floats:
    """(..., 6) the positive part of the principal membrane stresses; moments are zero."""
    middle = 0.5 * (stress[..., 0] + stress[..., 1])
    radius = np.hypot(0.5 * (stress[..., 0] - stress[..., 1]), stress[..., 2])
    high, low = middle + radius, middle - radius
    # a symmetric matrix with these principal values is p + q S; q = 1 if both are positive, 0 if both are negative
    share = np.where(low >= 0.0, 1.0, np.where(high <= 0.0, 0.0, high / np.maximum(high - low, 1e-300)))
    lift = np.where((low < 0.0) & (high > 0.0), -low * share, 0.0)
    out = np.zeros_like(stress)
    out[..., :3] = share[..., None] * stress[..., :3]
    out[..., :2] += lift[..., None]
    return out
