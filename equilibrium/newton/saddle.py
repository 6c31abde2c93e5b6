"""The way down from a saddle."""

from __future__ import annotations

from typing import Any

import numpy as np

from equilibrium.linear.sparse_pattern import Floats
from equilibrium.newton.minimise import Problem

State = Any

HALVINGS = 12
EQUAL = 0.01  # of the fall in energy: sides that differ less are the same


def left(problem: Problem, state: State, mode: Floats, longest: float) -> State:
    """The state moved along a negative mode (size,), to the lower side, as far as the energy falls.

    `longest` is the largest change of an unknown. At a symmetric saddle both sides are the same, and rounding would
    choose: then it is the one on which a fixed pseudo-random vector lies.
    """
    mark = np.random.default_rng(0).standard_normal(len(mode))
    vector = mode if mark @ mode >= 0.0 else -mode
    energy = problem.energy(state)
    (first, e1), (second, e2) = (_lowest(problem, state, energy, side, longest) for side in (vector, -vector))
    return second if e2 < e1 - EQUAL * abs(energy - e1) else first


def _lowest(problem: Problem, state: State, energy: float, vector: Floats, longest: float) -> tuple[State, float]:
    best, lowest = state, energy
    path, most = problem.path(state, vector, False)
    step = min(most, longest / float(np.abs(vector).max()))
    for _ in range(HALVINGS):
        trial = path(step)
        reached = problem.energy(trial)
        if reached < lowest:
            best, lowest = trial, reached
        step *= 0.5
    return best, lowest
