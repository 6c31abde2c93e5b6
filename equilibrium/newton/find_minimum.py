"""From an initial guess to a certified minimum: converge, check the exact Hessian, leave saddle points downwards.

The caller provides the iteration (an exact or inexact Newton's method). This module certifies its result. It reports a
minimum only if the exact Hessian is positive definite.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor, IterativeFactor
from asterism.equilibrium.linear.sparse_pattern import stiffen
from asterism.equilibrium.newton.certificate import leave_saddle, smallest_eigenvalue
from asterism.equilibrium.newton.minimise import Minimum, minimise
from asterism.equilibrium.newton.problem import AnyState, Problem


class HasRigidModes(Problem, Protocol):
    """A problem that provides its rigid motions."""

    def rigid_modes(self, state: AnyState) -> Floats:
        """Orthonormal motions (size, k) that cost no energy."""


Iterate = Callable[[AnyState], Minimum]
MAX_SADDLES = 6  # that are left; then the result is a saddle point


def find_minimum(
    problem: HasRigidModes,
    start: AnyState,
    factor: Factor,
    tolerance: float,
    iterate: Iterate,
    max_change: float,
    max_iterations: int = 200,
) -> Minimum:
    """Follow an initial guess to a minimum and certify it.

    Parameters
    ----------
    problem, start, factor, tolerance : as of `minimise`.
    iterate : takes a state to a stationary point, or fails; after a failure `minimise` continues.
    max_change : largest change of an unknown when a saddle point is left.
    max_iterations : of `minimise`; 0 ends the search after a failure of `iterate`.

    Raises
    ------
    FloatingPointError
        The Hessian is not finite.
    """
    clock = Clock()
    point = Minimum(start, np.inf, np.inf, tolerance, seconds=clock.seconds)

    def follow(state: AnyState) -> None:
        with clock("iterate"):
            result = iterate(state)
        _count(point, result)
        if not result.converged and max_iterations:
            point.fallbacks += 1
            lower = result.state if problem.energy(result.state) < problem.energy(state) else state
            with clock("minimise"):
                result = _descend(problem, lower, factor, tolerance, max_iterations)
            _count(point, result)
        point.state = result.state
        point.energy = problem.energy(point.state)
        point.gradient_norm = float(np.linalg.norm(problem.gradient(point.state)))

    follow(start)
    while np.isfinite(point.gradient_norm):
        with clock("certificate"):
            data = problem.hessian(point.state, 0.0)
            point.definite = is_definite_on_support(problem, point.state, data, factor)
        point.factorisations += 1
        if not point.converged or point.definite:
            break
        modes = problem.rigid_modes(point.state)
        with clock("eigenvalue"):
            point.lowest = smallest_eigenvalue(problem.pattern, data, factor, modes)
        point.factorisations += point.lowest.factorisations
        if point.lowest.value >= -point.lowest.error or point.saddles_left == MAX_SADDLES:
            break
        saddle_energy = point.energy
        perturbed = leave_saddle(problem, point.state, point.lowest.vector, max_change)
        follow(perturbed)
        if max_iterations and not (point.converged and point.energy <= saddle_energy):
            # the iteration climbed back to a higher energy: minimise from the perturbed state instead
            with clock("minimise"):
                result = _descend(problem, perturbed, factor, tolerance, max_iterations)
            _count(point, result)
            point.state, point.energy, point.gradient_norm = result.state, result.energy, result.gradient_norm
        point.saddles_left += 1
        point.lowest = None
    return point


def _count(point: Minimum, result: Minimum) -> None:
    point.iterations += result.iterations
    point.factorisations += result.factorisations


def _descend(problem: Problem, state: AnyState, factor: Factor, tolerance: float, max_iterations: int) -> Minimum:
    return minimise(problem, state, factor, tolerance, max_iterations, shift=0.0, check_definite=False)


def is_definite_on_support(problem: Problem, state: AnyState, data: Floats, factor: Factor) -> bool:
    """Whether the Hessian with entries `data` (nnz,), its rigid motions held by a support, is positive definite.

    If so, `factor` holds the Hessian with the support.
    """
    supported = data.copy()
    stiffen(problem.pattern, supported, problem.support(state))
    return factor.factorise(supported) and (not isinstance(factor, IterativeFactor) or factor.proves_definite())
