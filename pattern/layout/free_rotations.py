"""Rigid rotations that the supports leave to a sheet."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.free_motions import RIGID_MOTION_TOLERANCE, FreeMotions
from asterism.pattern.layout.layout import Layout


def free_rotation_axes(layout: Layout) -> Floats:
    """(k, 3) orthonormal axes of the rotations, with or without a translation, that all supports together leave free.

    All three axes for a free sheet, no axis where the supports determine how it lies. Gravity plays no part.
    """
    printed, places, _ = layout.support_samples
    fixed = ~np.isnan(places)
    if not fixed.any():
        return np.eye(3)
    # where the sheet slides, assume places near those of the print, at heights that no plane has
    x, y = (printed - printed.mean(axis=0)).T / max(float(np.ptp(printed, axis=0).max()), 1e-9)
    assumed = np.column_stack([printed, np.ptp(printed) * (0.07 * x**2 + 0.13 * y**2 + 0.09 * x * y)])
    points = np.where(fixed, places, assumed)
    free = FreeMotions(points, fixed).basis(points, points.mean(axis=0)).T
    _, sizes, axes = np.linalg.svd(free[:, 3:])
    return np.asarray(axes[: np.count_nonzero(sizes > RIGID_MOTION_TOLERANCE)])


def count_free_tilts(layout: Layout) -> int:
    """Number of independent horizontal axes about which the supports let the sheet rotate.

    If it is above 0, only gravity determines how the sheet lies.
    """
    return int(np.linalg.matrix_rank(free_rotation_axes(layout)[:, :2], RIGID_MOTION_TOLERANCE))
