"""Distances of shapes."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.rigid_fit import rigid_fit


def rms_distance(points: Floats, targets: Floats, mirrored: bool = False) -> float:
    """Root mean square distance (mm) of points (n, 3) after the best rigid motion; `mirrored`: the best reflection."""
    points = points * [-1.0, 1.0, 1.0] if mirrored else points
    rotation, shift = rigid_fit(points, targets)
    return float(np.sqrt(((points @ rotation.T + shift - targets) ** 2).sum(axis=1).mean()))
