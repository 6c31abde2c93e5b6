"""How to leave a saddle point of an energy."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.newton.problem import AnyState, Problem

MAX_HALVINGS = 12  # of the first step
EQUAL_DECREASE_FRACTION = 0.01  # of the decrease in energy; sides that differ by less count as equal


def leave_saddle(problem: Problem, state: AnyState, mode: Floats, max_change: float) -> AnyState:
    """State moved along a mode of negative curvature, to the lower side, as far as the energy decreases.

    At a symmetric saddle both sides are equal, and rounding errors would choose between them. A fixed pseudo-random
    vector chooses instead.

    Parameters
    ----------
    problem : the energy.
    state : the saddle point.
    mode : (size,) direction of negative curvature.
    max_change : largest change of a free unknown.
    """
    reference = np.random.default_rng(0).standard_normal(len(mode))
    vector = mode if reference @ mode >= 0.0 else -mode
    energy = problem.energy(state)
    (first, e1), (second, e2) = (_lowest_along(problem, state, energy, side, max_change) for side in (vector, -vector))
    return second if e2 < e1 - EQUAL_DECREASE_FRACTION * abs(energy - e1) else first


def _lowest_along(
    problem: Problem, state: AnyState, energy: float, vector: Floats, max_change: float
) -> tuple[AnyState, float]:
    lowest_state, lowest = state, energy
    path, longest = problem.path(state, vector)
    step = min(longest, max_change / float(np.abs(vector).max()))
    for _ in range(MAX_HALVINGS):
        trial = path(step)
        trial_energy = problem.energy(trial)
        if trial_energy < lowest:
            lowest_state, lowest = trial, trial_energy
        step *= 0.5
    return lowest_state, lowest
