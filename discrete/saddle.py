"""Saddles: how to see one, and the way down from it."""

from __future__ import annotations

import numpy as np

from discrete.model import Model
from discrete.state import State
from equilibrium.certificate import Eigenpair, smallest_eigenvalue
from equilibrium.factor import Factor, Iterative

LARGEST_MOVE_MM = 2.0
HALVINGS = 12
EQUAL = 0.01  # of the fall in energy: sides that differ less are the same


def lowest_mode(model: Model, state: State, factor: Factor, seed: int) -> Eigenpair:
    """Smallest eigenvalue of the exact Hessian and its mode, rigid motions left out."""
    data = model.hessian(state, 0.0)
    if isinstance(factor, Iterative):
        factor.near_nullspace(*model.near_nullspace(state))
    return smallest_eigenvalue(model.pattern, data, factor, model.rigid_modes(state), seed=seed)


def left(model: Model, state: State, pair: Eigenpair) -> State:
    """The state moved along a negative mode, to the lower side, as far as the energy falls, by 2 mm at most.

    At a symmetric saddle both sides are the same, and rounding would choose: then it is the one on which a fixed
    pseudo-random vector lies.
    """
    mark = np.random.default_rng(0).standard_normal(len(pair.vector))
    vector = pair.vector if mark @ pair.vector >= 0.0 else -pair.vector
    energy = model.energy(state)
    (first, e1), (second, e2) = (_lowest(model, state, energy, side) for side in (vector, -vector))
    return second if e2 < e1 - EQUAL * abs(energy - e1) else first


def _lowest(model: Model, state: State, energy: float, vector: np.ndarray) -> tuple[State, float]:
    best, lowest = state, energy
    path, longest = model.path(state, vector)
    step = min(longest, LARGEST_MOVE_MM / float(np.abs(vector).max()))
    for _ in range(HALVINGS):
        trial = path(step)
        reached = model.energy(trial)
        if reached < lowest:
            best, lowest = trial, reached
        step *= 0.5
    return best, lowest
