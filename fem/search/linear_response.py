"""Linear response of an equilibrium to small changes of fields, loads or supports: one solve with its Hessian.

With the gradient g of the changed energy and the Hessian H of the old equilibrium the response is `-H^-1 g`. The factor
holds H, as `fem.search.relax.relax` and `follow` leave it. The response is the first step of Newton's method with mixed
points, so `follow` continues from its state and strains and needs one iteration less.

If supports move by c, g is linear in c as well: the gradient at the old equilibrium, plus `K c` with the Hessian K over
all dofs. The gradient at the old state with moved supports would be useless, since it strains the adjacent triangles
far beyond the linear range.

Sensitivities are the responses to many small changes of the fields. A change dS of the stress at a fixed state changes
the gradient of the energy by `sum_q w B_q^T dS_q`, and with the Hessian H the equilibrium by `-H^-1` times that.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.search.mixed_newton import MAX_STEP
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell


@dataclass(frozen=True)
class Response:
    """An equilibrium after the change, to first order."""

    x: Floats  # (N, 3)
    _shell: Shell
    _start: Floats
    _before: Floats

    @cached_property
    def strains(self) -> Floats:
        """(T, Q, 6) mixed strains; computed at the first use."""
        return self._before + self._shell.assembly.strain_changes(self._start, self.x - self._start)


def linear_response(shell: Shell, x: Floats, factor: Factor) -> Response:
    """The linear response of an equilibrium to a change of fields, loads or supports.

    The response has no free rigid motions. That of a very soft sheet is shortened to the largest step of Newton's
    method.

    Parameters
    ----------
    shell : the shell after the change.
    x : (N, 3) mm, equilibrium before the change.
    factor : holds the Hessian at x before the change.
    """
    start = shell.constrain(x)
    # displacement of a support over the extent, below which it counts as zero
    if float(np.abs(start - x).max()) > 1e-9 * shell.extent:
        return _response_to_moved_supports(shell, x, start - x, factor)
    strains = shell.strains(start)
    _, stress, _ = shell.density(strains)
    gradient = shell.restrict(shell.assembly.forces(start, stress) + shell.load_gradient)
    move = shell.move(np.zeros_like(start), newton_step(shell, start, factor, gradient))
    largest = float(np.abs(move).max())
    limit = MAX_STEP * shell.extent
    return Response(start + (move if largest <= limit else limit / largest * move), shell, start, strains)


def _response_to_moved_supports(shell: Shell, x: Floats, moved: Floats, factor: Factor) -> Response:
    """The response of the equilibrium x (N, 3) to supports that move by `moved` (N, 3), and to changed fields."""
    strains = shell.strains(x)
    _, stress, stiffness = shell.density(strains)
    forces = shell.assembly.forces(x, stress) + shell.load_gradient
    forces = forces + shell.assembly.product(shell.assembly.tangent(x, stiffness, stress), moved)
    move = shell.move(moved, newton_step(shell, x, factor, shell.restrict(forces)))
    return Response(x + move, shell, x, strains)


def newton_step(shell: Shell, x: Floats, factor: Factor, gradient: Floats) -> Floats:
    """(n,) or (n, k) Newton steps for gradients over the free unknowns, without the free rigid motions."""
    step, rigid = -factor.solve(gradient), shell.rigid_modes(x)
    return np.asarray(step - rigid @ (rigid.T @ step))


def stress_under(shell: Shell, x: Floats, fields: Fields) -> Floats:
    """(T, Q, 6) stress that other fields would have at the state x (N, 3); the shell stays as it is.

    Raises `FieldError` if the fields are not admissible.
    """
    strains = shell.assembly.strains(x, fields.rest(shell.points))
    return np.asarray(fields.densities(shell.points)(strains)[1])


def stress_responses(shell: Shell, x: Floats, factor: Factor, changes: Iterable[Floats]) -> Floats:
    """(N, 3, P) displacements of the equilibrium x for P small changes of the stress, without free rigid motions.

    Parameters
    ----------
    shell : at equilibrium in x.
    x : (N, 3) mm.
    factor : holds the Hessian at x.
    changes : P arrays (T, Q, 6), changes of the stress at fixed x.
    """
    gradients = [shell.restrict(shell.assembly.forces(x, change)) for change in changes]
    if not gradients:
        return np.zeros((*x.shape, 0))
    steps, zero = newton_step(shell, x, factor, np.column_stack(gradients)), np.zeros_like(x)
    return np.stack([shell.move(zero, step) for step in steps.T], axis=-1)
