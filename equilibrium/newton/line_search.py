"""Backtracking line search along a curve of states."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.equilibrium.newton.problem import AnyState, Problem

ARMIJO_FRACTION = 1e-4  # sufficient decrease over the decrease that the slope predicts (Nocedal and Wright 2006)
MIN_STEP = 1e-8
MAX_REDUCTION = 0.1  # bounds of a new step over the last one
MIN_REDUCTION = 0.5
RELATIVE_ROUNDING = 1e-13  # rounding error of an energy over its value
RELATIVE_INITIAL_ROUNDING = 1e-16  # and over the first energy
ROUNDING_MARGIN = 1e3  # rounding errors below which a decrease is not significant


def rounding_error(energy: float, first_energy: float) -> float:
    """Rounding error of an energy. Terms that cancel at the end keep the rounding errors of the first energy."""
    return max(RELATIVE_ROUNDING * abs(energy), RELATIVE_INITIAL_ROUNDING * first_energy)


def line_search(
    problem: Problem,
    path: Callable[[float], AnyState],
    energy: float,
    first_energy: float,
    slope: float,
    gradient_norm: float,
    longest: float,
) -> tuple[AnyState, float, float] | None:
    """Backtrack until the energy decreases sufficiently (Armijo); None if no step above MIN_STEP does.

    Where the predicted decrease is below the rounding error of the energy, a smaller gradient decides.

    Parameters
    ----------
    problem : gives energy and gradient.
    path : step length to state; step 0 is the present state.
    energy, slope, gradient_norm : at step 0; the slope is the derivative along the path and negative.
    first_energy : of the whole minimisation, for its rounding error.
    longest : first step.

    Returns
    -------
    State, energy and step.
    """
    step = longest
    rounding = rounding_error(energy, first_energy)
    while step > MIN_STEP:
        state = path(step)
        trial = problem.energy(state)
        if np.isfinite(trial):
            if trial <= energy + ARMIJO_FRACTION * step * slope:
                return state, trial, step
            margin = ROUNDING_MARGIN * rounding
            insignificant = abs(step * slope) < margin and trial <= energy + margin
            if insignificant and np.linalg.norm(problem.gradient(state)) < gradient_norm:
                return state, trial, step
        # minimum of the parabola through the value and slope at 0 and the value at `step`
        curvature = trial - energy - step * slope
        best = -0.5 * slope * step * step / curvature if np.isfinite(curvature) and curvature > 0.0 else 0.1 * step
        step = min(max(best, MAX_REDUCTION * step), MIN_REDUCTION * step)
    return None
