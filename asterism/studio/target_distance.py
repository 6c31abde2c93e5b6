"""The target surface beside a shown sheet: distances, and the motion that lays it on the sheet."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.compare.nearest import NearestOnSurface
from asterism.measure.compare.registration import register
from asterism.measure.compare.scan import MAX_SCAN_POINTS, surface_samples
from asterism.studio.engine_orders import Surface
from asterism.studio.messages import TargetDistance, TargetPose


class TargetComparison:
    """Compares sheets with one target.

    Parameters
    ----------
    target : in the pose that is shown.
    version : of this target and pose.
    """

    def __init__(self, target: Surface, version: int) -> None:
        self._version = version
        self._vertices = np.asarray(target.vertices, dtype=float)
        self._triangles = np.asarray(target.triangles, dtype=np.int64)
        self._nearest = NearestOnSurface(self._vertices, self._triangles)

    def distance(self, positions: Floats, weights: Floats) -> TargetDistance:
        """Distances of places (V, 3) mm of a sheet; each stands for a share (V,) of the sheet."""
        away = np.abs(self._nearest(np.asarray(positions, dtype=float)).distance)
        rms = float(np.sqrt(weights @ away**2 / weights.sum()))
        return TargetDistance(away.astype(np.float32), rms, float(away.max()), self._version)

    def pose(self, seq: int, positions: Floats, triangles: Ints) -> TargetPose:
        """The motion that lays the target on a sheet with vertices (V, 3) mm and triangles (T, 3)."""
        samples, _ = surface_samples(self._vertices, self._triangles, MAX_SCAN_POINTS, np.random.default_rng(0))
        best = register(samples, np.asarray(positions, dtype=float), np.asarray(triangles, dtype=np.int64))[0]
        return TargetPose(seq, best.rotation, best.shift)
