"""Estimate of the discretisation error of a shape from its solutions on two or three meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import FreeMotions, free_motions
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.off_sheet import off_curves_mm
from asterism.shape.shape import Shape

# assumed order of convergence in the edge length if only two meshes are available: the stress is singular at the tips
# of the arms, and aligned meshes converge with this order (docs/explanation/mesh.md)
DEFAULT_MESH_ORDER = 1.0
# an observed order of convergence outside of these limits gives no estimate
MIN_OBSERVED_ORDER = 0.5
MAX_OBSERVED_ORDER = 2.5
# smallest ratio of the edge lengths of two meshes that gives an estimate
MIN_EDGE_RATIO = 1.2
# two shapes further apart than this, in % of the diameter, count as different minima
MAX_MESH_CHANGE_PERCENT = 10.0


@dataclass(frozen=True)
class MeshErrorEstimate:
    """Estimate of the discretisation error.

    Attributes
    ----------
    percent : rms error over the sheet, in % of the diameter; None if the meshes allow no estimate.
    order : order of convergence observed on three meshes; None with fewer, or if the distances do not decrease.
    change : rms distance to the shape on the next coarser mesh, in % of the diameter; None if only one mesh was solved.
    """

    percent: float | None
    order: float | None
    change: float | None


def mesh_error(
    fine: Shape,
    coarser: Sequence[tuple[Floats, Floats]],
    resolved: bool = True,
    order: float = DEFAULT_MESH_ORDER,
    layout: Layout | None = None,
    gravity: Sequence[float] | None = None,
) -> MeshErrorEstimate:
    """Estimate the discretisation error of `fine` by Richardson extrapolation.

    Shapes are compared as their supports hold them: only rigid motions that the supports leave free are taken out.

    Parameters
    ----------
    fine : the shape on the finest mesh.
    coarser : (V, 2) printed and (V, 3) deformed vertices (mm) of coarser meshes of the same sheet, the coarsest first.
    resolved : whether the mesh of `fine` resolves the creases. Otherwise all meshes may agree on a wrong shape, and
        there is no estimate.
    order : assumed order of convergence if only one coarser mesh can be used.
    layout : the sheet's supports; by default it has none.
    gravity : (3,) its direction if the sheet has weight.
    """
    edge = 1.0 / np.sqrt(len(fine.printed))
    free = FreeMotions()
    off_sheet = 0.0 if layout is None else off_curves_mm(layout, len(fine.printed))
    if layout is not None:
        supports = layout.support_samples
        free = free_motions(supports, fine.at(supports.printed, off_sheet), gravity)
    edges, distances = [], []
    for printed, positions in coarser[-2:]:
        edges.append(1.0 / np.sqrt(len(printed)))
        here = fine.at(printed, off_sheet)
        rotation, shift = free.fit(here, positions)
        distance = np.sqrt(((here @ rotation.T + shift - positions) ** 2).sum(axis=1).mean())
        distances.append(float(100.0 * distance / diameter(fine.positions)))
    return estimate([*edges, edge], distances, resolved, order)


def estimate(
    edges: Sequence[float], distances: Sequence[float], resolved: bool = True, order: float = DEFAULT_MESH_ORDER
) -> MeshErrorEstimate:
    """Estimate the error of the finest shape from its distances to one or two coarser shapes.

    If the error on a mesh is `c edge^p`, the distance to the finest shape is `c (edge^p - finest^p)`. Two distances
    determine the order p. There is no estimate if p is outside of its limits, if the shapes are so far apart that they
    are different minima, or if `resolved` is false.

    Parameters
    ----------
    edges : edge lengths of all meshes in any unit, the finest last.
    distances : in % of the diameter, one for each mesh but the finest.

    Examples
    --------
    An error of `2 edge` on meshes of edges 4, 2 and 1 gives the distances 6 and 2, and leaves 2 on the finest mesh.

    >>> result = estimate([4.0, 2.0, 1.0], [6.0, 2.0])
    >>> round(result.percent, 6), round(result.order, 6)
    (2.0, 1.0)
    """
    if not distances or edges[-2] / edges[-1] < MIN_EDGE_RATIO:
        return MeshErrorEstimate(None, None, None)
    observed = None
    if len(distances) > 1 and edges[-3] / edges[-2] >= MIN_EDGE_RATIO:
        observed = _observed(edges, distances)
        order = observed or 0.0
    percent = None
    if resolved and distances[-1] < MAX_MESH_CHANGE_PERCENT and MIN_OBSERVED_ORDER <= order <= MAX_OBSERVED_ORDER:
        percent = float(distances[-1] / ((edges[-2] / edges[-1]) ** order - 1.0))
    return MeshErrorEstimate(percent, observed, distances[-1])


def _observed(edges: Sequence[float], distances: Sequence[float]) -> float | None:
    """The order p of two distances, at most 4; None below 0.1."""
    coarse, middle, fine = edges[-3:]

    def residual(p: float) -> float:
        return float((coarse**p - fine**p) / (middle**p - fine**p) * distances[-1] - distances[-2])

    if residual(0.1) >= 0.0:
        return None
    from scipy.optimize import brentq  # slow to import; previews do without it

    return float(brentq(residual, 0.1, 4.0)) if residual(4.0) > 0.0 else 4.0
