"""How far a shape is from that of an infinitely fine mesh, from the meshes it was solved on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from asterism.shape.diameter import diameter
from asterism.shape.shape import Shape
from pattern.geometry.arrays import Floats
from pattern.geometry.rigid_fit import rms_distance

# Order of the distance by the edge length where it cannot be observed: that of a stress which is singular at the arms'
# tips, and what aligned meshes show in docs/explanation/mesh.md
ORDER = 1.0
# observed orders in between are believed
MIN_OBSERVED_ORDER = 0.5
MAX_OBSERVED_ORDER = 2.5
# meshes of nearly the same edge say nothing, and shapes further apart (% of the diameter) are different minima
SMALLEST_RATIO = 1.2
LARGEST_PERCENT = 10.0


@dataclass(frozen=True)
class MeshErrorEstimate:
    """Estimate of the discretisation error.

    Attributes
    ----------
    percent : rms over the sheet, in % of the diameter; None where the meshes do not show it.
    order : observed on the last three meshes; None with fewer, or where distances do not fall at all.
    change : % of the diameter, rms distance to the shape on the next coarser mesh; None if there is none.
    """

    percent: float | None
    order: float | None
    change: float | None


def mesh_error(
    fine: Shape, coarser: Sequence[tuple[Floats, Floats]], resolved: bool = True, order: float = ORDER
) -> MeshErrorEstimate:
    """Richardson's estimate of the discretisation error of `fine`.

    Parameters
    ----------
    coarser : (V, 2) printed and (V, 3) deformed vertices (mm) of coarser meshes of the same sheet, the coarsest first.
    resolved : the mesh of `fine` sees the creases. Meshes that do not may agree on a wrong shape.
    order : assumed where only one of them is of use.
    """
    edge = 1.0 / np.sqrt(len(fine.printed))
    edges, distances = [], []
    for printed, positions in coarser[-2:]:
        edges.append(1.0 / np.sqrt(len(printed)))
        distances.append(100.0 * rms_distance(fine.at(printed), positions) / diameter(fine.positions))
    return estimate([*edges, edge], distances, resolved, order)


def estimate(
    edges: Sequence[float], distances: Sequence[float], resolved: bool = True, order: float = ORDER
) -> MeshErrorEstimate:
    """From one or two distances (%) of coarser shapes to the finest; edges of all, in any unit, the finest last.

    An error `c edge^p` leaves the distances `c (edge^p - finest^p)`: two of them have one p. There is no estimate
    where p is none that theory knows, where the shapes are not two views of the same one, or unless `resolved`.
    """
    if not distances or edges[-2] / edges[-1] < SMALLEST_RATIO:
        return MeshErrorEstimate(None, None, None)
    observed = None
    if len(distances) > 1 and edges[-3] / edges[-2] >= SMALLEST_RATIO:
        observed = _observed(edges, distances)
        order = observed or 0.0
    percent = None
    if resolved and distances[-1] < LARGEST_PERCENT and MIN_OBSERVED_ORDER <= order <= MAX_OBSERVED_ORDER:
        percent = float(distances[-1] / ((edges[-2] / edges[-1]) ** order - 1.0))
    return MeshErrorEstimate(percent, observed, distances[-1])


def _observed(edges: Sequence[float], distances: Sequence[float]) -> float | None:
    """The order p that two distances have; None below 0.1, the largest is 4."""
    coarse, middle, fine = edges[-3:]

    def off(p: float) -> float:
        return float((coarse**p - fine**p) / (middle**p - fine**p) * distances[-1] - distances[-2])

    if off(0.1) >= 0.0:
        return None
    return float(brentq(off, 0.1, 4.0)) if off(4.0) > 0.0 else 4.0
