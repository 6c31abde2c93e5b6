"""Coefficients of the identity and of a constant in any space."""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.deformation import affine, flat
from asterism.fem.elements.space import Space


def flat_positions(space: Space) -> Floats:
    """(N, 3) mm, coefficients of the printed sheet in the plane z = 0."""
    return space.interpolate(flat().jets)


def constant(space: Space) -> Floats:
    """(N,) coefficients of the function one."""
    return np.ascontiguousarray(space.interpolate(affine(np.zeros((3, 2)), (1.0, 0.0, 0.0)).jets)[:, 0])
