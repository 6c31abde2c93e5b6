"""Maps of the sheet into space with their derivatives, for the tests of the shell."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.fem.elements.deformation import Deformation


def by_differences(place: Callable[[Floats], Floats], step: float = 1e-4) -> Deformation:
    """A map of printed points (n, 2) to (n, 3), its derivatives by differences over `step` mm."""
    one, two = step * np.eye(2)

    def gradient(p: Floats) -> Floats:
        return np.stack([place(p + d) - place(p - d) for d in (one, two)], axis=2) / (2.0 * step)

    def hessian(p: Floats) -> Floats:
        straight = [place(p + d) + place(p - d) - 2.0 * place(p) for d in (one, two)]
        mixed = place(p + one + two) + place(p - one - two) - place(p + one - two) - place(p - one + two)
        return np.stack([*straight, 0.25 * mixed], axis=2) / step**2

    return Deformation(place, gradient, hessian)


def arc(curvature: float) -> Deformation:
    """Cylinder about the second axis, concave on the side of its normal for a positive curvature per mm."""

    def place(p: Floats) -> Floats:
        turn = curvature * p[:, 0]
        return np.column_stack([np.sin(turn) / curvature, p[:, 1], (1.0 - np.cos(turn)) / curvature])

    return by_differences(place)
