"""Saddles of the exact model: how to see one, and the way down from it."""

from __future__ import annotations

from discrete.model import Model
from discrete.state import State
from equilibrium import saddle
from equilibrium.certificate import Eigenpair, smallest_eigenvalue
from equilibrium.factor import Factor, Iterative

LARGEST_MOVE_MM = 2.0


def lowest_mode(model: Model, state: State, factor: Factor, seed: int) -> Eigenpair:
    """Smallest eigenvalue of the exact Hessian and its mode, rigid motions left out."""
    data = model.hessian(state, 0.0)
    if isinstance(factor, Iterative):
        factor.near_nullspace(*model.near_nullspace(state))
    return smallest_eigenvalue(model.pattern, data, factor, model.rigid_modes(state), seed=seed)


def left(model: Model, state: State, pair: Eigenpair) -> State:
    """The state moved along a negative mode, to the lower side, as far as the energy falls, by 2 mm at most."""
    return saddle.left(model, state, pair.vector, LARGEST_MOVE_MM)
