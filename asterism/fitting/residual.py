"""The distance of a preview to its target, as residuals of a least-squares problem with their derivatives.

At each place of the print the residuals are the distance to the target along its normal at the nearest point, and,
with a small weight, the distance along the target from the point that the flattening assigns. The square of their
norm is about the mean square distance in mm^2. The sheet is the mean surface: the smooth surface and the mean of the
bumps over a cell.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fitting.flatten import TargetMap
from asterism.fitting.target import TargetSurface
from asterism.pattern.geometry.planar import distance_to_outline, inside
from asterism.pattern.geometry.rigid_fit import rigid_fit
from asterism.previews.places import Places
from asterism.results.records.fit import TargetDistanceRecord
from asterism.shape.measures import CellMean
from asterism.shape.shape import Shape

# places of the print this far off the triangles of the exact model are taken to them
OFF_SHEET_MM = 0.25


@dataclass(frozen=True, eq=False)
class FitDistance:
    """Signed distances of a shape to its target, positive on the plastic side."""

    shape: Shape  # the sheet; a free one is laid on the target
    surface_mm: Floats  # (V,) at the vertices of the shape, bumps included
    mean_mm: Floats  # (V,) its means over a cell of the lattice, in which the bumps cancel
    diameter_mm: float  # of the target
    place_weight: Floats  # (V,) of the target at the nearest points

    @cached_property
    def mean_percent(self) -> float:
        """Root mean square of the means over a cell, in % of the diameter."""
        return self._percent(np.sqrt(self.shape.weights @ self.mean_mm**2))

    @cached_property
    def weighted_percent(self) -> float:
        """The same by the weights of the places; `mean_percent` if all count alike."""
        share = self.shape.weights * self.place_weight
        return self._percent(np.sqrt(share @ self.mean_mm**2 / share.sum() * self.shape.weights.sum()))

    @property
    def farthest(self) -> Floats:
        """(3,) mm, the vertex of the largest distance with the bumps."""
        return np.asarray(self.shape.positions[int(np.abs(self.surface_mm).argmax())])

    @cached_property
    def record(self) -> TargetDistanceRecord:
        """The distance in numbers."""
        return TargetDistanceRecord(
            mean_percent=self.mean_percent,
            weighted_percent=self.weighted_percent,
            surface_percent=self._percent(np.sqrt(self.shape.weights @ self.surface_mm**2)),
            largest_percent=self._percent(np.abs(self.surface_mm).max()),
            largest_at_mm=[float(part) for part in np.round(self.farthest, 1)],
            is_minimum=bool(self.shape.summary["is_minimum"]),
        )

    def _percent(self, length: Any) -> float:
        return float(100.0 * length / self.diameter_mm)


def target_distance(shape: Shape, residual: Residual, lattice_vectors: Floats) -> FitDistance:
    """The distance of a shape to a target, at all vertices of the shape.

    `residual`: of the print; it lays a free sheet on the target; `lattice_vectors`: (2, 2) mm, rows.
    """
    target, places = residual.target, residual.places
    if not shape.held:
        rotation, shift = residual.pose(shape.at(places.points[: places.count]))
        shape = replace(shape, positions=shape.positions @ rotation.T + shift, point_fields={})
    surface = target.nearest(shape.positions).distance
    mean = CellMean(shape.printed, shape.weights, lattice_vectors)(surface[:, None])[:, 0]
    return FitDistance(shape, surface, mean, target.diameter_mm, target.weight_at(shape.positions))


@dataclass(frozen=True, eq=False)
class FitPlaces:
    """The places of the print at which the distance counts, for one outline."""

    points: Floats  # (n, 2) mm: the residual's places, `count` of them, then those over which bumps are averaged
    count: int
    goals: Floats  # (n, 3) mm, where the flattening has the points
    slide_weight: Floats  # (count,) weight of the distance along the target
    bump_mean: CellMean  # means of the bumps at the residual's places

    @classmethod
    def of(cls, target_map: TargetMap, outline: Floats, lattice_vectors: Floats) -> FitPlaces:
        """The places for an outline (n, 2) mm."""
        coarse = _grid(outline, 0.5 * target_map.spacing_mm)
        # of the spacing: places of the grid this near to the outline are left out, since the outline has its own
        coarse = coarse[distance_to_outline(coarse, outline) > 0.1 * target_map.spacing_mm]
        fine = _grid(outline, 0.125 * target_map.spacing_mm)
        points = np.concatenate([coarse, outline, fine])
        count = len(coarse) + len(outline)
        weight = np.concatenate([np.full(len(coarse), 0.15), np.full(len(outline), 0.5)])
        # the places themselves have no weight in the means: they would count twice
        shares = np.concatenate([np.full(count, 1e-9), np.ones(len(fine))])
        mean = CellMean(points, shares, lattice_vectors, np.arange(count))
        return cls(points, count, target_map.places(points), weight, mean)


def _grid(outline: Floats, step: float) -> Floats:
    low, high = outline.min(axis=0), outline.max(axis=0)
    middle = 0.5 * (low + high)
    half = np.ceil((high - middle) / step)
    axes = (np.arange(-count, count + 1) for count in half)
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2) * step + middle
    return np.asarray(points[inside(points, outline)])


@dataclass(frozen=True, eq=False)
class SheetState:
    """The residuals at one state of a sheet, at n places."""

    places: Floats  # (n, 3) mm, the mean surface in the pose of the target
    rotation: Floats  # (3, 3) of that pose; the unit matrix for supported sheets
    frame: Floats  # (n, 3, 3) rows: normal of the target, and two directions along it
    values: Floats  # (3 n,) residuals

    @property
    def rms_mm(self) -> float:
        """Root mean square distance to the target along its normal, by the weights of the places."""
        return float(np.linalg.norm(self.values[::3]))


class Residual:
    """Residuals of the sheets of one print.

    `target`: the surface; `places`: of the print; `is_free`: whether the sheet has no supports; then it is laid on the
    target.
    """

    def __init__(self, target: TargetSurface, places: FitPlaces, is_free: bool) -> None:
        self.target, self.places, self._is_free = target, places, is_free
        weight = target.weight_at(places.goals[: places.count])
        self._weight = weight / weight.mean()
        self._scale = np.sqrt(self._weight / places.count)

    def at(self, shown: Places) -> SheetState:
        """The residuals of a preview, shown at the points of `places`."""
        count = self.places.count
        return self._state(shown.smooth[:count] + self.places.bump_mean(shown.bumps), lambda values: values)

    def of_exact(self, shape: Shape) -> SheetState:
        """The residuals of an exact shape: means over a cell of its distances to the target.

        A mean of distances is not shifted inwards by the curvature of the sheet, as a mean of places would be.
        """
        return self._state(shape.at(self.places.points, OFF_SHEET_MM), self.places.bump_mean)

    def _state(self, surface: Floats, mean: Callable[[Floats], Floats]) -> SheetState:
        """The residuals of a surface (m, 3) at the first m points, with a mean of their values at the n places."""
        count, rotation = self.places.count, np.eye(3)
        if self._is_free:
            rotation, shift = self.pose(surface[:count])
            surface = surface @ rotation.T + shift
        nearest = self.target.nearest(surface)
        normals = self.target.interpolate(self.target.vertex_normals, nearest.places, nearest.triangle)
        frame = _frames(normals / np.linalg.norm(normals, axis=1, keepdims=True))
        normal = mean(np.einsum("nc,nc->n", surface - nearest.places, frame[:, 0])[:, None])
        along = np.einsum("nc,nkc->nk", mean(surface - self.places.goals[: len(surface)]), frame[:count, 1:])
        values = self._scale[:, None] * np.hstack([normal, self.places.slide_weight[:, None] * along])
        return SheetState(surface[:count], rotation, frame[:count], values.ravel())

    def pose(self, surface: Floats) -> tuple[Floats, Floats]:
        """Rotation and shift that lay places (n, 3) of a free sheet on the target, by iterated nearest points."""
        all_goals = self.places.goals[: self.places.count]
        rotation, shift = rigid_fit(surface, all_goals, self._weight)
        slide = self.places.slide_weight[:, None] ** 2
        for _ in range(30):
            moved = surface @ rotation.T + shift
            goals = (self.target.nearest(moved).places + slide * all_goals) / (1.0 + slide)
            rotation, shift = rigid_fit(surface, goals, self._weight)
            if np.abs(surface @ rotation.T + shift - moved).max() < 1e-4:
                break
        return rotation, shift

    def derivatives(self, state: SheetState, moves: Floats) -> Floats:
        """(3 n, P) derivatives of the residuals for moves (n, 3, P) of the places.

        Those of a free sheet do not contain rigid motions, to which the registration adapts.
        """
        columns = self._columns(state, np.einsum("ab,nbp->nap", state.rotation, moves))
        if not self._is_free:
            return columns
        arm = state.places - state.places.mean(axis=0)
        turns = np.stack([np.cross(axis, arm) for axis in np.eye(3)], axis=-1)
        rigid = self._columns(state, np.concatenate([turns, np.broadcast_to(np.eye(3), turns.shape)], axis=-1))
        return np.asarray(columns - rigid @ np.linalg.lstsq(rigid, columns, rcond=None)[0])

    def exact_derivatives(self, state: SheetState, moves: Floats) -> Floats:
        """The derivatives for moves (m, 3, P) of all points of an exact shape: of their means over a cell."""
        means = self.places.bump_mean(moves.reshape(len(moves), -1))
        return self.derivatives(state, means.reshape(-1, *moves.shape[1:]))

    def _columns(self, state: SheetState, moves: Floats) -> Floats:
        """(3 n, P) of the residuals, for motions (n, 3, P) of the places."""
        along = np.einsum("nkc,ncp->nkp", state.frame, moves)
        along[:, 1:] *= self.places.slide_weight[:, None, None]
        return np.asarray((self._scale[:, None, None] * along).reshape(3 * len(along), -1))


def _frames(normals: Floats) -> Floats:
    """(n, 3, 3) orthonormal rows for unit normals (n, 3): the normal and two directions across it."""
    helper = np.where(np.abs(normals[:, :1]) < 0.8, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = np.cross(normals, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return np.stack([normals, first, np.cross(normals, first)], axis=1)
