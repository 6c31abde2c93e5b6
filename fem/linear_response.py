"""What an equilibrium does when fields, loads or conditions change a little: one solve with the factor at hand.

The factor holds the exact Hessian of the old equilibrium, as `fem.solve.relax` and `follow` leave it. The answer is the
first step of Newton's method with mixed points, so `follow` goes on from its x and strains: an edit costs one
iteration less than it would.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from equilibrium.factor import Factor
from fem.mixed_newton import FAR
from fem.shell import Shell
from fem.tabulation import Floats


@dataclass(frozen=True)
class Response:
    """An equilibrium after the change, to first order.

    Attributes
    ----------
    x : (N, 3).
    """

    x: Floats
    _shell: Shell
    _start: Floats
    _before: Floats

    @cached_property
    def strains(self) -> Floats:
        """(T, Q, 6); whoever shows x does not wait for them."""
        return self._before + self._shell.assembly.strain_changes(self._start, self.x - self._start)


def linear_response(shell: Shell, x: Floats, factor: Factor) -> Response:
    """Where the equilibrium x (N, 3) goes, now that the shell has other fields, loads or moved conditions.

    The factor holds the Hessian at x from before the change. A soft sheet may answer by more than it is large: a longer
    move than Newton's method makes is shortened to that. Rigid motions that nothing stops are taken out: of all
    answers that differ by one this is the one that moves the least.
    """
    start = shell.held(x)
    strains = shell.strains(start)
    _, stress, _ = shell.density(strains)
    gradient = shell.restricted(shell.assembly.forces(start, stress) + shell.outer_forces(start))
    step = -factor.solve(gradient)
    modes = shell.rigid_modes(start)
    move = shell.move(np.zeros_like(start), step - modes @ (modes.T @ step))
    farthest = float(np.abs(move).max())
    most = FAR * shell.size
    return Response(start + (move if farthest <= most else most / farthest * move), shell, start, strains)
