"""The tube that a rolled sheet is nearest to."""

from __future__ import annotations

import numpy as np
from scipy.optimize import least_squares

from pattern.layout import Floats


def tube_radius(points: Floats) -> float:
    """mm, of the circular cylinder closest to points (n, 3) mm in the sense of least squares.

    Axis, place and radius are free; the best of fits from the three principal directions and a few places is taken.
    """
    points = points - points.mean(axis=0)
    size = float(np.sqrt((points**2).sum(axis=1).mean()))

    def across(a: Floats, axes: Floats) -> Floats:
        axis = axes[0] + a[0] * axes[1] + a[1] * axes[2]
        axis /= np.linalg.norm(axis)
        return np.linalg.norm(np.cross(points - a[2] * axes[1] - a[3] * axes[2], axis), axis=1)

    principal = np.linalg.svd(points, full_matrices=False)[2]
    offsets = 0.3 * size * np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
    fits = [
        least_squares(lambda a, axes=axes: across(a, axes) - a[4], [0.0, 0.0, *offset, 0.6 * size])
        for axes in (np.roll(principal, -i, axis=0) for i in range(3))
        for offset in offsets
    ]
    return float(abs(min(fits, key=lambda fit: fit.cost).x[4]))
