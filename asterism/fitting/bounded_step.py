"""The step of a bounded least-squares problem: damped normal equations with an active set."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats

# each round fixes or frees at least one unknown; the step is admissible after any number of rounds
MAX_ACTIVE_SET_ROUNDS = 60


def bounded_step(normal: Floats, gradient: Floats, low: Floats, high: Floats) -> Floats:
    """(P,) the step s that minimises `s N s / 2 + g s` within `low <= s <= high`, where `low <= 0 <= high`.

    Unknowns whose unbounded solution leaves the bounds stay at them as long as the gradient pushes outwards.

    Parameters
    ----------
    normal : (P, P) N, positive definite: the matrix of the normal equations with its damping.
    gradient : (P,) g.
    low, high : (P,) bounds of the step.

    Examples
    --------
    >>> bounded_step(np.diag([2.0, 2.0]), np.array([-4.0, -1.0]), np.full(2, -1.0), np.full(2, 1.0)).tolist()
    [1.0, 0.5]
    """
    step = np.zeros(len(gradient))
    is_fixed = np.zeros(len(gradient), dtype=bool)
    for _ in range(MAX_ACTIVE_SET_ROUNDS):
        free = ~is_fixed
        target = step.copy()
        if free.any():
            right = -gradient[free] - normal[np.ix_(free, is_fixed)] @ step[is_fixed]
            target[free] = np.linalg.solve(normal[np.ix_(free, free)], right)
        # largest share of the way to the solution that stays within the bounds
        way = target - step
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(way > 0.0, (high - step) / way, np.where(way < 0.0, (low - step) / way, np.inf))
        share = float(np.clip(room[free].min(initial=np.inf), 0.0, 1.0))
        step = np.clip(step + share * way, low, high)
        if share < 1.0:
            blocking = free & (room <= share * (1.0 + 1e-12) + 1e-15)
            is_fixed |= blocking
            # exactly at the bound: rounding must not make an upper bound look like a place between both
            step[blocking] = np.where(way > 0.0, high, low)[blocking]
            continue
        slope = normal @ step + gradient
        # at an upper bound the slope must push up, at a lower bound down
        wrong = np.where(is_fixed, np.where(step >= high, slope, -slope), 0.0)
        worst = int(wrong.argmax())
        if wrong[worst] <= 1e-12 * (1.0 + np.abs(gradient).max()):
            break
        is_fixed[worst] = False
    return step
