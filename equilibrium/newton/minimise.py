"""Newton's method for the minimum of an energy, and the way from an initial guess to a certified minimum.

Where the Hessian H is indefinite, the matrix is `(1 - b) H + b H_psd`, with the smallest b that the factorisation
accepts. Steps are along the path of the problem, which may rotate what a straight step would stretch.

`find_minimum` follows a guess by an iteration of the caller (an exact or inexact Newton's method), and leaves saddle
points downwards. It reports a minimum only if the exact Hessian is positive definite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor, IterativeFactor
from asterism.equilibrium.linear.multigrid import NotPositiveDefiniteError
from asterism.equilibrium.linear.sparse_pattern import stiffen
from asterism.equilibrium.newton.certificate import Eigenpair, leave_saddle, smallest_eigenvalue
from asterism.equilibrium.newton.problem import AnyState, HasNearNullspace, Problem

SADDLE_ITERATIONS = 4  # in a row with an indefinite Hessian and hardly a decrease; then a saddle is near
MIN_STEP = 1e-8


@dataclass(frozen=True)
class Iteration:
    """Report of one iteration."""

    number: int  # from 0, the initial state
    # energy, gradient_norm: at the present state.
    energy: float
    gradient_norm: float
    blend: float  # regularisation, b
    step: float  # length of the step that led here


@dataclass
class Minimum:
    """Where a search for a minimum has ended, with the evidence whether this state is one."""

    # state, energy, gradient_norm: at the end.
    state: AnyState
    energy: float
    gradient_norm: float
    tolerance: float  # limit of the gradient norm
    # the exact Hessian (plus a shift) at the end, on an isostatic support, is positive definite; False as well if it
    # was not checked.
    definite: bool = False
    # iterations, factorisations: their total numbers.
    iterations: int = 0
    factorisations: int = 0
    # smallest eigenvalue and its mode; None where the Hessian is definite, or if it was not computed.
    lowest: Eigenpair | None = None
    fallbacks: int = 0  # how often `minimise` continued after another iteration had failed
    saddles_left: int = 0  # number of saddle points left on the way
    seconds: dict[str, float] = field(default_factory=dict)  # wall time by part
    # of `minimise`, one entry for each iteration, the initial state first.
    history: list[Iteration] = field(default_factory=list)
    stagnated: bool = False  # not converged, but rounding errors allow no further progress
    # the last step was a full one with the exact Hessian, which was positive definite there, and its model lowered the
    # energy by at most `small_decrease`.
    settled: bool = False
    # ended by `saddle_decrease`: steps with an indefinite Hessian hardly lowered the energy.
    near_saddle: bool = False
    blend: float = 0.0  # regularisation with which the minimisation of a similar problem may begin

    @property
    def converged(self) -> bool:
        """The gradient norm is at most the tolerance."""
        return self.gradient_norm <= self.tolerance

    @property
    def is_minimum(self) -> bool:
        """Converged, and the exact Hessian is positive definite."""
        return self.converged and self.definite


def minimise(
    problem: Problem,
    state: AnyState,
    factor: Factor,
    tolerance: float,
    max_iterations: int = 300,
    shift: float = 1e-9,
    report: Callable[[Iteration], None] | None = None,
    blend: float = 0.0,
    check_definite: bool = True,
    small_decrease: float = 0.0,
    saddle_decrease: float = 0.0,
) -> Minimum:
    """Minimise the energy of a problem by Newton's method with a line search.

    Raises `FloatingPointError` if the Hessian is not finite.

    Parameters
    ----------
    problem : the energy.
    state : initial guess.
    factor : solver for the Hessians, see `equilibrium.linear.backends.make_solver`.
    tolerance : of the gradient's 2-norm.
    max_iterations : largest number of iterations.
    shift : added to the diagonal of every matrix.
    report : called after every iteration.
    blend : first regularisation. A good guess saves the factorisations of matrices that would be refused.
    check_definite : factorise the exact Hessian at the last state, for `Minimum.definite`, unless it has settled.
    small_decrease : the iteration also ends after a full step that lowers the quadratic model of the energy by at most
        this, which soft modes cannot mislead as they do the gradient's norm.
    saddle_decrease : the iteration also ends after `SADDLE_ITERATIONS` steps in which the exact Hessian was not
        positive definite and the model lowered the energy by at most this. Regularised steps leave a saddle point
        slowly, while a step along its negative mode leaves it at once.
    """
    clock = Clock()
    history: list[Iteration] = []
    energy = problem.energy(state)
    first_energy = abs(energy)
    with clock("gradient"):
        gradient = problem.gradient(state)
    norm = float(np.linalg.norm(gradient))
    regularisation = Regularisation(problem, factor, shift, clock, blend)
    step = 0.0
    line_search_failed = settled = False
    at_saddle = 0  # steps in a row
    lowest_energy, smallest_norm, last_progress = energy, norm, 0
    for number in range(max_iterations + 1):
        history.append(Iteration(number, energy, norm, regularisation.amount, step))
        if report:
            report(history[-1])
        # at the end a step may lower the energy by less than its rounding error, but then the gradient decreases
        if energy < lowest_energy - _rounding_error(energy, first_energy) or norm < 0.9 * smallest_norm:
            lowest_energy, smallest_norm, last_progress = min(lowest_energy, energy), min(smallest_norm, norm), number
        # so many iterations without progress: rounding errors allow no further progress
        stagnated = number >= last_progress + 10
        ended = norm <= tolerance or line_search_failed or number == max_iterations or not np.isfinite(norm)
        if ended or stagnated or settled or at_saddle == SADDLE_ITERATIONS:
            break
        direction = regularisation.direction(state, gradient)
        path, longest = problem.path(state, direction)
        slope = float(gradient @ direction)
        with clock("line search"):
            accepted = _line_search(problem, path, energy, first_energy, slope, norm, min(1.0, longest))
        if accepted is None:
            line_search_failed = not regularisation.increase()
            continue
        state, energy, step = accepted
        with clock("gradient"):
            gradient = problem.gradient(state)
        norm = float(np.linalg.norm(gradient))
        settled = regularisation.is_exact and step == 1.0 and -0.5 * slope <= small_decrease
        at_saddle = at_saddle + 1 if regularisation.amount and -0.5 * slope <= saddle_decrease else 0
        regularisation.decrease()
    return Minimum(
        state=state,
        energy=energy,
        gradient_norm=norm,
        tolerance=tolerance,
        definite=check_definite and (settled or regularisation.is_definite(state)),
        iterations=len(history) - 1,
        factorisations=regularisation.factorisations,
        seconds=clock.seconds,
        history=history,
        stagnated=tolerance < norm and stagnated,
        settled=settled,
        near_saddle=at_saddle == SADDLE_ITERATIONS and not ended,
        blend=regularisation.proven or 0.0,
    )


def _rounding_error(energy: float, first_energy: float) -> float:
    """Rounding error of an energy. Terms that cancel at the end keep the rounding errors of the first energy."""
    return max(1e-13 * abs(energy), 1e-16 * first_energy)


def _line_search(
    problem: Problem,
    path: Callable[[float], AnyState],
    energy: float,
    first_energy: float,
    slope: float,
    gradient_norm: float,
    longest: float,
) -> tuple[AnyState, float, float] | None:
    """Backtrack until the energy decreases sufficiently (Armijo); None if no step above MIN_STEP does.

    Where the predicted decrease is below the rounding error of the energy, a smaller gradient decides.

    It returns state, energy and step. Energy, gradient norm and slope (negative) are those at step 0 of the path;
    `first_energy` is that of the whole minimisation, for its rounding error.
    """
    step = longest
    rounding = _rounding_error(energy, first_energy)
    while step > MIN_STEP:
        state = path(step)
        trial = problem.energy(state)
        if np.isfinite(trial):
            # sufficient decrease over the decrease that the slope predicts (Nocedal and Wright 2006)
            if trial <= energy + 1e-4 * step * slope:
                return state, trial, step
            # a decrease by less is not significant
            margin = 1e3 * rounding
            insignificant = abs(step * slope) < margin and trial <= energy + margin
            if insignificant and np.linalg.norm(problem.gradient(state)) < gradient_norm:
                return state, trial, step
        # minimum of the parabola through the value and slope at 0 and the value at `step`
        curvature = trial - energy - step * slope
        best = -0.5 * slope * step * step / curvature if np.isfinite(curvature) and curvature > 0.0 else 0.1 * step
        step = min(max(best, 0.1 * step), 0.5 * step)
    return None


# Factor on the regularisation after a refused matrix. A refused matrix costs as much as an accepted one, so the blend,
# which ends at 1, gets there from 1e-3 in three refusals.
GROWTH = 30.0
# Stiffness added to the convex model where it has none, over the median diagonal entry of the exact Hessian.
CONVEX_STIFFNESS_FRACTION = 1e-3
MIN_AMOUNT = 1e-3  # first amount after a refused matrix; amounts below become zero
MAX_FORCING_TERM = 1e-2  # largest relative residual of an iterative solution


class Regularisation:
    """Makes the matrix `(1 - b) H + b H_psd` positive definite with the smallest b that the factorisation accepts.

    Parameters
    ----------
    problem, factor : the energy and the solver for its Hessians.
    shift : added to the diagonal of every matrix.
    clock : takes the time of each part.
    amount : first b.
    """

    def __init__(self, problem: Problem, factor: Factor, shift: float, clock: Clock, amount: float) -> None:
        self._problem, self._factor, self._shift, self._clock = problem, factor, shift, clock
        self._iterative = factor if isinstance(factor, IterativeFactor) else None
        self.amount = amount  # present b; 0 is the exact Hessian
        # b with which a similar problem may begin: that of the first direction, or less if it was accepted at once
        self.proven: float | None = None
        self.factorisations = 0  # matrices given to the factor so far
        self._was_refused = False  # a matrix of the last direction
        self._solved_norm = 0.0  # norm of the last gradient that was solved for
        self._support: Ints = np.empty(0, dtype=np.int64)

    def direction(self, state: AnyState, gradient: Floats) -> Floats:
        """Descent direction (size,) from a positive definite matrix close to the Hessian.

        Raises `FloatingPointError` if the Hessian is not finite.
        """
        if self._iterative and isinstance(self._problem, HasNearNullspace):
            self._iterative.set_near_nullspace(*self._problem.near_nullspace(state))
        with self._clock("support"):
            self._support = self._problem.support(state)
        exact, convex = self._hessian(state, 0.0), None
        diagonal = self._problem.pattern.diagonal  # after the Hessian, which may change the pattern
        # absolute values, since under compression most diagonal entries can be negative
        added = CONVEX_STIFFNESS_FRACTION * float(np.median(np.abs(exact[diagonal])))
        self._was_refused = False
        while True:
            if self.amount == 0.0:
                data = exact
            else:
                if convex is None:
                    convex = self._hessian(state, 1.0)
                    # semidefinite is not definite: slack fabric without bending has directions without stiffness
                    convex[diagonal] += added
                blend = min(self.amount, 1.0)
                data = (1.0 - blend) * exact + blend * convex
                if self.amount > 1.0:
                    data[diagonal] += added * self.amount
            if self._factorise(data):
                try:
                    with self._clock("solve"):
                        step = -self._solve(gradient)
                    if self.proven is None:
                        self.proven = self.amount if self._was_refused else _lower(self.amount / GROWTH)
                    return step
                except NotPositiveDefiniteError:
                    pass
            if not np.isfinite(data).all():
                raise FloatingPointError("the Hessian is not finite")
            self._was_refused = True
            self.amount = max(GROWTH * self.amount, MIN_AMOUNT)

    def is_definite(self, state: AnyState) -> bool:
        """Whether the exact Hessian with the shift, on its support, is positive definite; one factorisation."""
        with self._clock("support"):
            self._support = self._problem.support(state)
        accepted = self._factorise(self._hessian(state, 0.0))
        return accepted and (not self._iterative or self._iterative.proves_definite())

    @property
    def is_exact(self) -> bool:
        """The last direction is that of the exact Hessian, which a factorisation has proven positive definite."""
        return self.amount == 0.0 and self._iterative is None

    def decrease(self) -> None:
        """After a successful step: reduce the amount, unless the step needed an increase."""
        if not self._was_refused:
            self.amount = _lower(0.1 * self.amount)

    def increase(self) -> bool:
        """After a failed line search: increase the amount; False if it is at its limit."""
        if self.amount >= 1.0:
            return False
        self.amount = max(10.0 * self.amount, 1e-2)
        return True

    def _hessian(self, state: AnyState, blend: float) -> Floats:
        with self._clock("hessian"):
            data = self._problem.hessian(state, blend)
        pattern = self._problem.pattern
        data[pattern.diagonal] += self._shift
        # rigid motions cost no energy: a support changes the step by a rigid motion, and only zeros of the inertia
        stiffen(pattern, data, self._support)
        return data

    def _solve(self, gradient: Floats) -> Floats:
        if not self._iterative:
            return self._factor.solve(gradient)
        # inexact at first, then exact enough for quadratic convergence (Eisenstat and Walker 1996, choice 2)
        norm = float(np.linalg.norm(gradient))
        forcing = MAX_FORCING_TERM
        if self._solved_norm > 0.0:
            forcing = min(MAX_FORCING_TERM, 0.9 * (norm / self._solved_norm) ** 2)
        self._solved_norm = norm
        return self._iterative.solve(gradient, max(forcing, 1e-10))

    def _factorise(self, data: Floats) -> bool:
        self.factorisations += 1
        with self._clock("factorisation"):
            return bool(self._factor.factorise(data))


def _lower(amount: float) -> float:
    return amount if amount >= 0.99 * MIN_AMOUNT else 0.0


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

    Raises `FloatingPointError` if the Hessian is not finite.

    Parameters
    ----------
    problem, start, factor, tolerance : as of `minimise`.
    iterate : takes a state to a stationary point, or fails; after a failure `minimise` continues.
    max_change : largest change of an unknown when a saddle point is left.
    max_iterations : of `minimise`; 0 ends the search after a failure of `iterate`.
    """
    clock = Clock()
    point = Minimum(start, np.inf, np.inf, tolerance, seconds=clock.seconds)

    def descend(state: AnyState) -> Minimum:
        return minimise(problem, state, factor, tolerance, max_iterations, shift=0.0, check_definite=False)

    def counted(part: str, search: Iterate, state: AnyState) -> Minimum:
        with clock(part):
            result = search(state)
        point.iterations += result.iterations
        point.factorisations += result.factorisations
        return result

    def follow(state: AnyState) -> None:
        result = counted("iterate", iterate, state)
        if not result.converged and max_iterations:
            point.fallbacks += 1
            lower = result.state if problem.energy(result.state) < problem.energy(state) else state
            result = counted("minimise", descend, lower)
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
            result = counted("minimise", descend, perturbed)
            point.state, point.energy, point.gradient_norm = result.state, result.energy, result.gradient_norm
        point.saddles_left += 1
        point.lowest = None
    return point


def is_definite_on_support(problem: Problem, state: AnyState, data: Floats, factor: Factor) -> bool:
    """Whether the Hessian with entries `data` (nnz,), its rigid motions held by a support, is positive definite.

    If so, `factor` holds the Hessian with the support.
    """
    supported = data.copy()
    stiffen(problem.pattern, supported, problem.support(state))
    return factor.factorise(supported) and (not isinstance(factor, IterativeFactor) or factor.proves_definite())
