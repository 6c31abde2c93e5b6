"""Maps of the sheet into space with their derivatives, for the tests of the shell."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.deformation import Deformation


def stacked(rows: list[list[Floats | float]], points: Floats) -> Floats:
    """(n, 3, k) array from k rows of three components."""
    parts = [np.stack(np.broadcast_arrays(*row, points[:, 0])[:3], axis=1) for row in rows]
    return np.stack(parts, axis=2)


def arc(curvature: float) -> Deformation:
    """Cylinder about the second axis, concave on the side of its normal for a positive curvature per mm."""
    k = curvature

    def position(p: Floats) -> Floats:
        return np.stack([np.sin(k * p[:, 0]) / k, p[:, 1], (1.0 - np.cos(k * p[:, 0])) / k], axis=1)

    def gradient(p: Floats) -> Floats:
        return stacked([[np.cos(k * p[:, 0]), 0.0, np.sin(k * p[:, 0])], [0.0, 1.0, 0.0]], p)

    def hessian(p: Floats) -> Floats:
        flat = [0.0, 0.0, 0.0]
        return stacked([[-k * np.sin(k * p[:, 0]), 0.0, k * np.cos(k * p[:, 0])], flat, flat], p)

    return Deformation(position, gradient, hessian)
