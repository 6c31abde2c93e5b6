"""Newton's method with mixed points as the iteration of a search for a minimum."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.newton.minimise import Minimum
from asterism.fem.search.mixed_newton import mixed_newton
from asterism.fem.shell.shell import Shell


def mixed(shell: Shell, factor: Factor, tolerance: float) -> Callable[[Floats], Minimum]:
    """The iteration from a state, with a tolerance in N."""

    def iterate(x: Floats) -> Minimum:
        end = mixed_newton(shell, x, factor, tolerance)
        return Minimum(end.x, np.nan, end.residual, tolerance, iterations=end.iterations)

    return iterate
