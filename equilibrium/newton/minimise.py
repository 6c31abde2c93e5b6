"""Newton's method for the minimum of an energy.

Where the Hessian H is indefinite, the matrix is `(1 - b) H + b H_psd`, with the smallest b that the factorisation
accepts. Steps are along the path of the problem, which may rotate what a straight step would stretch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor
from asterism.equilibrium.newton.certificate import Eigenpair
from asterism.equilibrium.newton.problem import AnyState, Problem
from asterism.equilibrium.newton.regularisation import Regularisation

MAX_IDLE_ITERATIONS = 10  # in a row without progress; then rounding errors allow no further progress
MIN_GRADIENT_PROGRESS = 0.9  # of the smallest gradient norm so far; a norm below counts as progress
SADDLE_ITERATIONS = 4  # in a row with an indefinite Hessian and hardly a decrease; then a saddle is near
ARMIJO_FRACTION = 1e-4  # sufficient decrease over the decrease that the slope predicts (Nocedal and Wright 2006)
MIN_STEP = 1e-8
MAX_REDUCTION = 0.1  # bounds of a new step over the last one
MIN_REDUCTION = 0.5
RELATIVE_ROUNDING = 1e-13  # rounding error of an energy over its value
RELATIVE_INITIAL_ROUNDING = 1e-16  # and over the first energy
ROUNDING_MARGIN = 1e3  # rounding errors below which a decrease is not significant


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

    Raises
    ------
    FloatingPointError
        The Hessian is not finite.
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
        if (
            energy < lowest_energy - _rounding_error(energy, first_energy)
            or norm < MIN_GRADIENT_PROGRESS * smallest_norm
        ):
            lowest_energy, smallest_norm, last_progress = min(lowest_energy, energy), min(smallest_norm, norm), number
        stagnated = number >= last_progress + MAX_IDLE_ITERATIONS
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
    return max(RELATIVE_ROUNDING * abs(energy), RELATIVE_INITIAL_ROUNDING * first_energy)


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
            if trial <= energy + ARMIJO_FRACTION * step * slope:
                return state, trial, step
            margin = ROUNDING_MARGIN * rounding
            insignificant = abs(step * slope) < margin and trial <= energy + margin
            if insignificant and np.linalg.norm(problem.gradient(state)) < gradient_norm:
                return state, trial, step
        # minimum of the parabola through the value and slope at 0 and the value at `step`
        curvature = trial - energy - step * slope
        best = -0.5 * slope * step * step / curvature if np.isfinite(curvature) and curvature > 0.0 else 0.1 * step
        step = min(max(best, MAX_REDUCTION * step), MIN_REDUCTION * step)
    return None
