"""Sensitivities of an equilibrium: its linear response to many small changes of the fields, with one factorisation.

A change dS of the stress at a fixed state changes the gradient of the energy by `sum_q w B_q^T dS_q`, and with the
Hessian H the equilibrium by `-H^-1` times that.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.linear.factor import Factor
from asterism.fem.shell.fields import Fields
from asterism.fem.shell.shell import Shell


def stress_under(shell: Shell, x: Floats, fields: Fields) -> Floats:
    """(T, Q, 6) stress that other fields would have at the state x (N, 3); the shell stays as it is.

    Raises
    ------
    FieldError
        The fields are not admissible.
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
    steps = -np.asarray(factor.solve(np.column_stack(gradients)))
    rigid = shell.rigid_modes(x)
    steps = steps - rigid @ (rigid.T @ steps)
    zero = np.zeros_like(x)
    return np.stack([shell.move(zero, step) for step in steps.T], axis=-1)
