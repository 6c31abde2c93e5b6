"""The distance of a sheet in space to its target."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fitting.residual import Residual
from asterism.shape.cell_mean import CellMean
from asterism.shape.shape import Shape


@dataclass(frozen=True, eq=False)
class FitDistance:
    """Signed distances of a shape to its target, positive on the plastic side.

    Attributes
    ----------
    shape : the sheet; a free one is laid on the target.
    surface_mm : (V,) at the vertices of the shape, bumps included.
    mean_mm : (V,) its means over a cell of the lattice, in which the bumps cancel.
    diameter_mm : of the target.
    place_weight : (V,) of the target at the nearest points.
    """

    shape: Shape
    surface_mm: Floats
    mean_mm: Floats
    diameter_mm: float
    place_weight: Floats

    @cached_property
    def mean_percent(self) -> float:
        """Root mean square of the means over a cell, in % of the diameter."""
        return self._percent(np.sqrt(self.shape.weights @ self.mean_mm**2))

    @cached_property
    def weighted_percent(self) -> float:
        """The same by the weights of the places; `mean_percent` if all count alike."""
        share = self.shape.weights * self.place_weight
        return self._percent(np.sqrt(share @ self.mean_mm**2 / share.sum() * self.shape.weights.sum()))

    @cached_property
    def surface_percent(self) -> float:
        """Root mean square with the bumps, in % of the diameter."""
        return self._percent(np.sqrt(self.shape.weights @ self.surface_mm**2))

    @cached_property
    def largest_percent(self) -> float:
        """Largest distance with the bumps, in % of the diameter."""
        return self._percent(np.abs(self.surface_mm).max())

    @property
    def farthest(self) -> Floats:
        """(3,) mm, the vertex of the largest distance."""
        return np.asarray(self.shape.positions[int(np.abs(self.surface_mm).argmax())])

    def _percent(self, length: Any) -> float:
        return float(100.0 * length / self.diameter_mm)


def target_distance(shape: Shape, residual: Residual, lattice_vectors: Floats) -> FitDistance:
    """The distance of a shape to a target, at all vertices of the shape.

    Parameters
    ----------
    residual : of the print; it lays a free sheet on the target.
    lattice_vectors : (2, 2) mm, rows.
    """
    target, places = residual.target, residual.places
    if not shape.held:
        rotation, shift = residual.pose(shape.at(places.points[: places.count]))
        shape = replace(shape, positions=shape.positions @ rotation.T + shift, point_fields={})
    surface = target.nearest(shape.positions).distance
    mean = CellMean(shape.printed, shape.weights, lattice_vectors)(surface[:, None])[:, 0]
    return FitDistance(shape, surface, mean, target.diameter_mm, target.weight_at(shape.positions))
