"""What an equilibrium does when fields, loads or conditions change a little: one solve with the factor at hand.

The factor holds the exact Hessian of the old equilibrium, as `fem.search.relax.relax` and `follow` leave it. The answer
is the first step of Newton's method with mixed points, so `follow` goes on from its x and strains: an edit costs one
iteration less than it would.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from equilibrium.linear.factor import Factor
from fem.elements.tabulation import Floats
from fem.search.mixed_newton import MAX_STEP
from fem.shell.fields import Fields
from fem.shell.shell import Shell


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
    start = shell.constrain(x)
    strains = shell.strains(start)
    _, stress, _ = shell.density(strains)
    gradient = shell.restrict(shell.assembly.forces(start, stress) + shell.external_gradient(start))
    move = shell.move(np.zeros_like(start), _answer(shell, start, factor, gradient))
    farthest = float(np.abs(move).max())
    most = MAX_STEP * shell.extent
    return Response(start + (move if farthest <= most else most / farthest * move), shell, start, strains)


def rms_response(shell: Shell, x: Floats, factor: Factor, fields: Fields) -> float:
    """mm, rms over the printed sheet: how far the equilibrium x goes, to first order, if its fields are others.

    The shell stays as it is. Of answers that differ by a rigid motion which nothing stops, the smallest counts. The
    factor holds the Hessian at x (N, 3).

    Raises
    ------
    FieldError
        No sheet can have these fields.
    """
    strains = shell.assembly.strains(x, fields.rest(shell.points))
    _, stress, _ = fields.densities(shell.points)(strains)
    move = _answer(shell, x, factor, shell.restrict(shell.assembly.forces(x, stress) + shell.external_gradient(x)))
    rigid = shell.rigid_modes(x)
    if rigid.shape[1]:
        image = shell.mass @ rigid
        move = move - rigid @ np.linalg.solve(rigid.T @ image, image.T @ move)
    square = float(move @ (shell.mass @ move[:, None])[:, 0])
    return float(np.sqrt(max(square, 0.0) / shell.assembly.weights.sum()))


def _answer(shell: Shell, x: Floats, factor: Factor, gradient: Floats) -> Floats:
    """(n,) step of the free unknowns that a gradient (n,) asks for, without the rigid motions that nothing stops."""
    step, rigid = -factor.solve(gradient), shell.rigid_modes(x)
    return np.asarray(step - rigid @ (rigid.T @ step))
