"""Saddles of the exact model: how to see one, and the way down from it."""

from __future__ import annotations

from discrete.model.model import Model
from discrete.model.state import State
from discrete.release.starts import unit
from equilibrium.linear.factor import Factor, IterativeFactor
from equilibrium.newton.certificate import Eigenpair, smallest_eigenvalue
from equilibrium.newton.saddle import leave_saddle

LARGEST_MOVE_MM = 2.0  # at the paper's spacing of the stars, and in proportion at others


def lowest_mode(model: Model, state: State, factor: Factor, seed: int) -> Eigenpair:
    """Smallest eigenvalue of the exact Hessian and its mode, rigid motions left out."""
    data = model.hessian(state, 0.0)
    if isinstance(factor, IterativeFactor):
        factor.set_near_nullspace(*model.near_nullspace(state))
    return smallest_eigenvalue(model.pattern, data, factor, model.rigid_modes(state), seed=seed)


def left(model: Model, state: State, pair: Eigenpair) -> State:
    """The state moved along a negative mode, to the lower side, while the energy falls, by a ninth of the spacing."""
    away: State = leave_saddle(model, state, pair.vector, unit(model) * LARGEST_MOVE_MM)
    return away
