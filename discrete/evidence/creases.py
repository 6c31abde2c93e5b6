"""The width of the fabric's creases along the arms, and whether the mesh resolves them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.discrete.energies.membrane import invariants, volumetric_derivatives
from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.equilibrium.arrays import Array

MAX_EDGE_OVER_WIDTH = 0.7  # 1: height of the triangles at the arms over the width of a crease, if it is resolved


@dataclass(frozen=True)
class Creases:
    """Creases of a deformed sheet. A kink over an arm decays like `exp(-distance/width)` in a sheet under tension.

    Attributes
    ----------
    width : mm, `sqrt(D/N)` with the bending stiffness D and the mean tension N of the triangles at the arms.
    edge : mm, median height of these triangles over the arm.
    """

    width: float
    edge: float

    @property
    def resolved(self) -> bool:
        """A crease spans more than one triangle; on such meshes tubes converge (docs/explanation/mesh.md)."""
        return self.edge <= MAX_EDGE_OVER_WIDTH * self.width


def measure_creases(model: DiscreteModel, state: State) -> Creases:
    """Measure the creases of a state. The width is zero without bending stiffness and infinite without tension."""
    triangles, edges = model.mesh.triangles, np.sort(model.edges, axis=1)
    corner = state.positions[triangles]
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2)
    size = model.n_vertices
    at_arm = np.isin(sides @ [size, 1], edges @ [size, 1])
    step = np.roll(corner, -1, axis=1) - corner
    twice = np.linalg.norm(np.cross(step[:, 0], step[:, 1]), axis=1)
    height = twice[:, None] / np.linalg.norm(step, axis=2)
    beside = at_arm.any(axis=1)
    bending = model.design.fabric.bending_tensor.d11
    tension = float(_tension(model, state, 0.5 * twice)[beside].mean())
    width = np.sqrt(bending / tension) if tension > 0.0 else np.inf
    return Creases(float(width), float(np.median(height[at_arm])))


def _tension(model: DiscreteModel, state: State, area: Array) -> Array:
    """(T,) N/mm of deformed length, mean of the two principal tensions; `area` is the deformed area (T,) mm^2."""
    fabric = model.parts["membrane"]
    p = fabric.params.T
    _, _, c11, _, c22, log_j = invariants(state.packed[fabric.inputs.T], p)
    by_log_j, _ = volumetric_derivatives(p, log_j)
    # half the trace of F S F^T, with the second Piola-Kirchhoff stress times rest volume S
    return np.asarray((0.5 * p[6] * (c11 + c22) + by_log_j) / area)
