"""From a start to a certified equilibrium: converge, ask the exact Hessian, leave saddles on their lower side.

The problem says how it converges (Newton's method of its own, exact or not); this says what the result is. A state
whose Hessian is not positive definite is never called a minimum.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from equilibrium.linear.factor import Factor, Iterative
from equilibrium.linear.rigid_support import stiffen
from equilibrium.linear.sparse_pattern import Floats
from equilibrium.newton.certificate import Eigenpair, smallest_eigenvalue
from equilibrium.newton.minimise import Clock, Problem, minimise
from equilibrium.newton.saddle import left

State = Any


class Solvable(Problem, Protocol):
    """A problem whose rigid motions are known."""

    def rigid_modes(self, state: State) -> Floats:
        """(size, k) orthonormal motions that cost nothing."""


class Run(Protocol):
    """Where an iteration stopped: `equilibrium.newton.minimise.Minimum` is one."""

    @property
    def state(self) -> State: ...

    @property
    def converged(self) -> bool: ...

    @property
    def iterations(self) -> int: ...

    @property
    def factorisations(self) -> int: ...


Iterate = Callable[[State], Run]


@dataclass
class Settled:
    """A state and the evidence for what it is.

    Attributes
    ----------
    state : the last one.
    gradient_norm, tolerance : 2-norm over the free unknowns, and what it is compared with.
    definite : the exact Hessian, rigid motions held, was factorised with positive pivots only.
    lowest : the smallest eigenvalue and its mode, where it was asked for; without that, None.
    iterations, factorisations : all of them.
    fallbacks : times that the problem's own iteration failed and the energy was followed down instead.
    saddles_left : on the way here.
    seconds : by part.
    """

    state: State
    energy: float
    gradient_norm: float
    tolerance: float
    definite: bool
    lowest: Eigenpair | None = None
    iterations: int = 0
    factorisations: int = 0
    fallbacks: int = 0
    saddles_left: int = 0
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def converged(self) -> bool:
        """The gradient is below the tolerance."""
        return self.gradient_norm <= self.tolerance

    @property
    def is_minimum(self) -> bool:
        """Converged, and the exact Hessian is positive definite."""
        return self.converged and self.definite


def settle(
    problem: Solvable,
    start: State,
    factor: Factor,
    tolerance: float,
    iterate: Iterate,
    longest: float,
    max_saddles: int = 6,
    max_iterations: int = 200,
) -> Settled:
    """Follow a start to an equilibrium and certify it.

    Parameters
    ----------
    iterate : takes a state to a stationary one, or fails; then `equilibrium.newton.minimise.minimise` goes on.
    longest : largest change of an unknown when a saddle is left.
    max_saddles : to leave before giving up; the result is then a saddle and says so.
    max_iterations : of `minimise`; 0 gives up instead.
    """
    clock = Clock()
    found = Settled(start, np.inf, np.inf, tolerance, False, seconds=clock.seconds)

    def follow(state: State) -> None:
        run = clock("iterate", iterate, state)
        _count(found, run)
        if not run.converged and max_iterations:
            found.fallbacks += 1
            lower = run.state if problem.energy(run.state) < problem.energy(state) else state
            run = clock("minimise", _down, problem, lower, factor, tolerance, max_iterations)
            _count(found, run)
        found.state = run.state
        found.energy = problem.energy(found.state)
        found.gradient_norm = float(np.linalg.norm(problem.gradient(found.state)))

    follow(start)
    while np.isfinite(found.gradient_norm):
        data = clock("certificate", problem.hessian, found.state, 0.0)
        found.definite = clock("certificate", held_definite, problem, found.state, data, factor)
        found.factorisations += 1
        if not found.converged or found.definite:
            break
        modes = problem.rigid_modes(found.state)
        found.lowest = clock("eigenvalue", smallest_eigenvalue, problem.pattern, data, factor, modes)
        found.factorisations += found.lowest.factorisations
        if found.lowest.value >= -found.lowest.error or found.saddles_left == max_saddles:
            break
        energy, kicked = found.energy, left(problem, found.state, found.lowest.vector, longest)
        follow(kicked)
        if max_iterations and not (found.converged and found.energy <= energy):
            # it went back up: follow the energy down instead
            run = clock("minimise", _down, problem, kicked, factor, tolerance, max_iterations)
            _count(found, run)
            found.state, found.energy, found.gradient_norm = run.state, run.energy, run.gradient_norm
        found.saddles_left += 1
        found.lowest = None
    return found


def _count(found: Settled, run: Run) -> None:
    found.iterations += run.iterations
    found.factorisations += run.factorisations


def _down(problem: Problem, state: State, factor: Factor, tolerance: float, max_iterations: int) -> Any:
    return minimise(problem, state, factor, tolerance, max_iterations, shift=0.0, verdict=False)


def held_definite(problem: Problem, state: State, data: Floats, factor: Factor) -> bool:
    """Is the matrix positive definite, its rigid motions held by an isostatic support? If so the factor holds it."""
    held = data.copy()
    stiffen(problem.pattern, held, problem.support(state))
    return factor.factorise(held) and (not isinstance(factor, Iterative) or factor.proves_definite())
