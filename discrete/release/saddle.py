"""Saddles of the exact model: how to see one, and the way down from it."""

from __future__ import annotations

from discrete.model.discrete_model import DiscreteModel
from discrete.model.state import State
from discrete.release.release_start import spacing_ratio
from equilibrium.linear.factor import Factor, IterativeFactor
from equilibrium.newton.certificate import Eigenpair, smallest_eigenvalue
from equilibrium.newton.saddle import leave_saddle

MAX_SADDLE_MOVE_MM = 2.0  # at the paper's spacing of the stars, and in proportion at others


def lowest_mode(model: DiscreteModel, state: State, factor: Factor, seed: int) -> Eigenpair:
    """Smallest eigenvalue of the exact Hessian and its mode, rigid motions left out."""
    data = model.hessian(state, 0.0)
    if isinstance(factor, IterativeFactor):
        factor.set_near_nullspace(*model.near_nullspace(state))
    return smallest_eigenvalue(model.pattern, data, factor, model.rigid_modes(state), seed=seed)


def leave_saddle_of_model(model: DiscreteModel, state: State, pair: Eigenpair) -> State:
    """The state moved along a negative mode, to the lower side, while the energy falls, by a ninth of the spacing."""
    away: State = leave_saddle(model, state, pair.vector, spacing_ratio(model) * MAX_SADDLE_MOVE_MM)
    return away
