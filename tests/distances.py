"""Distances of shapes."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.pattern.layout.free_motions import FreeMotions
from asterism.pattern.layout.symmetries import Symmetry, distances_of_images


def rms_distance(points: Floats, targets: Floats, mirrored: bool = False) -> float:
    """Root mean square distance (mm) of points (n, 3) after the best rigid motion; `mirrored`: the best reflection."""
    points = points * [-1.0, 1.0, 1.0] if mirrored else points
    rotation, shift = rigid_fit(points, targets)
    return float(np.sqrt(((points @ rotation.T + shift - targets) ** 2).sum(axis=1).mean()))


def symmetric_distances(
    printed: Floats, first: Floats, second: Floats, same: list[Symmetry], free: FreeMotions | None = None
) -> Floats:
    """`distances_of_images` of two shapes at printed points (n, 2) that the symmetries map onto themselves."""
    tree = cKDTree(printed)
    return distances_of_images(printed, first, lambda at: second[tree.query(at)[1]], same, free or FreeMotions())
