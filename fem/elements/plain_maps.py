"""Coefficients of the plainest maps in any space."""

from __future__ import annotations

import numpy as np

from fem.elements.deformation import affine, flat
from fem.elements.space import Space
from fem.elements.tabulation import Floats


def flat_positions(space: Space) -> Floats:
    """(N, 3) the printed sheet."""
    return space.interpolate(flat().jets)


def constant(space: Space) -> Floats:
    """(N,) the function one."""
    return np.ascontiguousarray(space.interpolate(affine(np.zeros((3, 2)), (1.0, 0.0, 0.0)).jets)[:, 0])
