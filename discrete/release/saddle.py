"""Saddle points of the exact model: the lowest mode, and the descent along it."""

from __future__ import annotations

from asterism.discrete.model.discrete_model import DiscreteModel
from asterism.discrete.model.state import State
from asterism.discrete.release.release_start import spacing_ratio
from asterism.equilibrium.linear.factor import Factor, IterativeFactor
from asterism.equilibrium.newton.certificate import Eigenpair, smallest_eigenvalue
from asterism.equilibrium.newton.saddle import leave_saddle

# mm, largest displacement when a saddle is left, at the paper's spacing of the stars and in proportion at others
MAX_SADDLE_MOVE_MM = 2.0


def lowest_mode(model: DiscreteModel, state: State, factor: Factor, seed: int) -> Eigenpair:
    """Smallest eigenvalue of the exact Hessian and its mode, without the rigid motions; `seed` starts Lanczos."""
    data = model.hessian(state, 0.0)
    if isinstance(factor, IterativeFactor):
        factor.set_near_nullspace(*model.near_nullspace(state))
    return smallest_eigenvalue(model.pattern, data, factor, model.rigid_modes(state), seed=seed)


def leave_saddle_of_model(model: DiscreteModel, state: State, pair: Eigenpair) -> State:
    """The state moved along a negative mode to its lower side, while the energy falls and no further than the limit."""
    lower: State = leave_saddle(model, state, pair.vector, spacing_ratio(model) * MAX_SADDLE_MOVE_MM)
    return lower
