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
from asterism.pattern.geometry.planar import cross_2d
from asterism.pattern.layout.layout import Layout

GRADED_EDGE_FACTOR = 0.3  # edge at an arm or a tip over the edge far from both
REACH_SPACINGS = 0.25  # distance from the arms, in spacings, at which edges have their full length
ARM_SAMPLES_A_SPACING = 200  # sample points of an arm on one spacing
# least weight of a spring: diagonals of squares have none of their own
MIN_SPRING_WEIGHT = 0.05
MAX_ROUNDS = 30
STEP_EDGES = 0.01  # points that move by less have reached their places
PLACES = np.linspace(0.0, 1.0, 1001)  # at which the sizes of edges along a line are known


@dataclass(frozen=True)
class Grading:
    """Relative lengths of edges: `GRADED_EDGE_FACTOR` at arms, growing with the distance up to 1 at `reach` (mm)."""

    arms: cKDTree
    reach: float

    @classmethod
    def of(cls, layout: Layout) -> Grading:
        """For all rods of a layout."""
        samples = [rod.at(rod.points, _even_parts(rod.length, layout.spacing_mm)) for rod in layout.graph.rods]
        return cls(cKDTree(np.concatenate([np.empty((0, 2)), *samples])), REACH_SPACINGS * layout.spacing_mm)

    @classmethod
    def of_arms(cls, centre: Floats, tip: Floats, spacing: float) -> Grading:
        """For arms from their stars' centres (A, 2) to their tips (A, 2); all lengths in mm."""
        step = tip - centre
        along = _even_parts(float(np.linalg.norm(step, axis=1).max(initial=0.0)), spacing)
        return cls(cKDTree((centre[:, None] + along[:, None] * step[:, None]).reshape(-1, 2)), REACH_SPACINGS * spacing)

    def distance(self, points: Floats) -> Floats:
        """(n,) mm, of points (n, 2) from the nearest arm."""
        return np.asarray(self.arms.query(points)[0])

    def between(self, one: Floats, other: Floats) -> Floats:
        """(n,) of edges between points at these distances (n,) from the arms: the harmonic mean along the edge."""
        passed = [self._passed(distance) for distance in (one, other)]
        step = other - one
        even = np.abs(step) < 1e-6 * self.reach
        mean = np.where(even, 1.0, step) / np.where(even, 1.0, passed[1] - passed[0])
        return np.where(even, self.ramp(0.5 * (one + other)), mean)

    def _passed(self, distance: Floats) -> Floats:
        """(n,) mm, the integral of 1/size over the distance from an arm."""
        slope = (1.0 - GRADED_EDGE_FACTOR) / self.reach
        within = np.log1p(slope * np.minimum(distance, self.reach) / GRADED_EDGE_FACTOR) / slope
        return within + np.maximum(distance - self.reach, 0.0)

    def along(self, length: float, count: int) -> Floats:
        """(count + 1,) parts of an arm of this length (mm) at which its vertices are; they crowd at the tip, 1."""
        return graded_parts(np.linspace(0.0, 1.0, count + 1), self.ramp((1.0 - PLACES) * length))

    def ramp(self, distance: Floats) -> Floats:
        """(n,) of edges at distances (n,) in mm from the arms."""
        return GRADED_EDGE_FACTOR + (1.0 - GRADED_EDGE_FACTOR) * np.minimum(distance / self.reach, 1.0)

    def settled(
        self,
        points: Floats,
        ends: Callable[[Floats], tuple[Floats, Floats]],
        means: Callable[[Floats], Floats],
        edge_mm: float,
    ) -> Floats:
        """Points (n, 2) mm at rest between springs that are stiffer where edges are short.

        Parameters
        ----------
        points : (n, 2) mm, where they start.
        ends : both ends (E, 2) of all edges, from the points.
        means : the points, each the mean of its neighbours, from the weights (E,) of the edges.
        edge_mm : of the grid.
        """
        for round_ in range(MAX_ROUNDS):
            one, other = (self.distance(end) for end in ends(points))
            target = means(1.0 / self.between(one, other))
            step = target - points
            # sizes follow the points: half steps avoid oscillation
            points = target if round_ == 0 else points + 0.5 * step
            if np.abs(step).max(initial=0.0) < STEP_EDGES * edge_mm:
                break
        return points


def half_cotangents(one: Floats, other: Floats) -> Floats:
    """(n,) of the angles between vectors (n, 2): the sum over both angles opposite to an edge is its weight."""
    return np.asarray(0.5 * (one * other).sum(axis=1) / np.abs(cross_2d(one, other)))


def graded_parts(parts: Floats, size: Floats) -> Floats:
    """Parts (n,) of a line, from 0 to 1, moved so that its edges follow the sizes (m,) at `PLACES`."""
    passed = np.concatenate([[0.0], np.cumsum(1.0 / size[1:] + 1.0 / size[:-1])])
    return np.interp(parts * passed[-1], passed, PLACES)


def _even_parts(length: float, spacing: float) -> Floats:
    """(n,) parts of a rod from 0 to 1, close enough for distances to it."""
    return np.linspace(0.0, 1.0, max(int(np.ceil(ARM_SAMPLES_A_SPACING * length / spacing)), 1) + 1)
