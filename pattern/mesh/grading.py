"""Meshes that are finer where the fabric creases: across the arms, and about their tips.

A line that does not stretch, in a sheet under tension: the sheet creases along it within sqrt(D/N), about a third of a
millimetre, and its stress is singular at the line's end. Away from both the shape is smooth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.aligned.lattice_grid import GridPatch

GRADED_EDGE_FACTOR = 0.15  # edge at an arm or a tip over the edge far from both
REACH_SPACINGS = 1 / 6  # distance from the arms, in spacings, at which edges have their full length
ARM_SAMPLES_A_SPACING = 200  # sample points of an arm on one spacing
MAX_ROUNDS = 30
STEP_EDGES = 0.01  # points that move by less have reached their places


@dataclass(frozen=True)
class Grading:
    """Relative lengths of edges: `GRADED_EDGE_FACTOR` at arms, growing with the distance up to 1 at `reach` (mm)."""

    arms: cKDTree
    reach: float

    @classmethod
    def of(cls, layout: Layout) -> Grading:
        """For all arms of a layout."""
        return cls.of_arms(layout.centres[layout.arm_star], layout.arm_tip, layout.spacing_mm)

    @classmethod
    def of_arms(cls, centre: Floats, tip: Floats, spacing: float) -> Grading:
        """For arms from their stars' centres (A, 2) to their tips (A, 2); all lengths in mm."""
        step = tip - centre
        longest = float(np.linalg.norm(step, axis=1).max(initial=0.0))
        along = np.linspace(0.0, 1.0, max(int(np.ceil(ARM_SAMPLES_A_SPACING * longest / spacing)), 1) + 1)
        return cls(cKDTree((centre[:, None] + along[:, None] * step[:, None]).reshape(-1, 2)), REACH_SPACINGS * spacing)

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
        return GRADED_EDGE_FACTOR + (1.0 - GRADED_EDGE_FACTOR) * np.minimum(distance / self.reach, 1.0)

    def spread(self, patch: GridPatch, known: np.ndarray, places: Floats) -> Floats:
        """Places (n, 2) of all points of a patch, given for those `known` (n,): springs stiffer where edges are short.

        Winslow's variable diffusion: each free point is the mean of its neighbours, weighted with 1/size between them.
        """
        ends = patch.edges().T
        points = patch.grid.place(patch.ij)
        points = points + patch.harmonic(known, places - points)
        points = self.settled(
            points,
            lambda points: 0.5 * (points[ends[0]] + points[ends[1]]),
            lambda stiff: patch.harmonic(known, places, stiff),
            patch.grid.edge_mm,
        )
        return np.where(known[:, None], places, points)

    def settled(
        self,
        points: Floats,
        middles: Callable[[Floats], Floats],
        means: Callable[[Floats], Floats],
        edge_mm: float,
    ) -> Floats:
        """Points (n, 2) mm at rest between springs that are stiffer where edges are short.

        Parameters
        ----------
        points : (n, 2) mm, where they start.
        middles : the middles (E, 2) of all edges, from the points.
        means : the points, each the mean of its neighbours, from the weights (E,) of the edges.
        edge_mm : of the grid.
        """
        for round_ in range(MAX_ROUNDS):
            target = means(1.0 / self.size(middles(points)))
            step = target - points
            # sizes follow the points: half steps avoid oscillation
            points = target if round_ == 0 else points + 0.5 * step
            if np.abs(step).max(initial=0.0) < STEP_EDGES * edge_mm:
                break
        return points
