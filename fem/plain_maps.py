"""Coefficients of the plainest maps in any space."""

from __future__ import annotations

import numpy as np

from fem.space import Space
from fem.tabulation import Floats


def flat_positions(space: Space) -> Floats:
    """(N, 3) the printed sheet."""

    def gradient(p: Floats) -> Floats:
        return np.broadcast_to(np.eye(3)[:, :2], (len(p), 3, 2))

    return space.interpolate(lambda p: np.column_stack([p, np.zeros(len(p))]), gradient, _none)


def constant(space: Space) -> Floats:
    """(N,) the function one."""
    one = space.interpolate(lambda p: np.ones((len(p), 3)), lambda p: np.zeros((len(p), 3, 2)), _none)
    return np.ascontiguousarray(one[:, 0])


def _none(points: Floats) -> Floats:
    return np.zeros((len(points), 3, 3))
