"""Meshes that are finer where the fabric creases: across the arms, and about their tips.

A line that does not stretch, in a sheet under tension: the sheet creases along it within sqrt(D/N), about a third of a
millimetre, and its stress is singular at the line's end. Away from both the shape is smooth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout
from pattern.mesh.aligned.lattice_grid import GridPatch

FINEST = 0.15  # edge at an arm, or at a tip, over the edge far from them
REACH = 1 / 6  # distance at which that is, over the stars' distance
SAMPLES = 200  # points to a lattice distance that stand for an arm
# Rounds of moving all points: at most so many, or until nothing moves by more than this part of an edge
ROUNDS, STILL = 30, 0.01


@dataclass(frozen=True)
class Grading:
    """Relative lengths of edges: `FINEST` at arms, growing with the distance up to 1 at `reach` (mm)."""

    arms: cKDTree
    reach: float

    @classmethod
    def of(cls, layout: Layout) -> Grading:
        """For all arms of a layout."""
        spacing = layout.spacing_mm
        start, step = layout.centres[layout.arm_star], layout.arm_tip - layout.centres[layout.arm_star]
        longest = float(layout.arm_length.max(initial=0.0))
        along = np.linspace(0.0, 1.0, max(int(np.ceil(SAMPLES * longest / spacing)), 1) + 1)
        return cls(cKDTree((start[:, None] + along[:, None] * step[:, None]).reshape(-1, 2)), REACH * spacing)

    def size(self, points: Floats) -> Floats:
        """(n,) of edges at points (n, 2)."""
        return self._ramp(self.arms.query(points)[0])

    def along(self, length: float, count: int) -> Floats:
        """(count + 1,) parts of an arm of this length (mm) at which its vertices are; they crowd at the tip, 1."""
        place = np.linspace(0.0, 1.0, 1001)
        density = 1.0 / self._ramp((1.0 - place) * length)
        passed = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
        return np.interp(np.linspace(0.0, passed[-1], count + 1), passed, place)

    def _ramp(self, distance: Floats) -> Floats:
        return FINEST + (1.0 - FINEST) * np.minimum(distance / self.reach, 1.0)

    def spread(self, patch: GridPatch, known: np.ndarray, places: Floats) -> Floats:
        """Places (n, 2) of all points of a patch, given for those `known` (n,): springs stiffer where edges are short.

        Winslow's variable diffusion: each free point is the mean of its neighbours, weighted with 1/size between them.
        """
        ends = patch.edges().T
        points = patch.grid.place(patch.ij)
        points = points + patch.harmonic(known, places - points)
        for round_ in range(ROUNDS):
            stiff = 1.0 / self.size(0.5 * (points[ends[0]] + points[ends[1]]))
            wanted = patch.harmonic(known, places, stiff)
            step = wanted - points
            # sizes follow the points: half the way keeps the two from swinging
            points = wanted if round_ == 0 else points + 0.5 * step
            if np.abs(step).max(initial=0.0) < STILL * patch.grid.edge_mm:
                break
        return np.where(known[:, None], places, points)
