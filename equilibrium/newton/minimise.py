"""Newton's method for the minimum of an energy, with two ways of handling an indefinite Hessian.

`blended` (default): `(1 - b) H + b H_psd`, b as small as the factorisation allows, and steps along the problem's own
path (which may turn what a straight step would stretch). `shifted`: `H + tau I` and straight steps, as in the paper
(Nocedal and Wright 2006, section 3.4).
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol, runtime_checkable

import numpy as np

from equilibrium.linear.conjugate_gradients import NotPositiveDefinite
from equilibrium.linear.factor import Factor, Iterative
from equilibrium.linear.rigid_support import stiffen
from equilibrium.linear.sparse_pattern import Floats, Ints, SparsePattern

State = Any
Method = Literal["blended", "shifted"]


# a refused matrix costs as much as an accepted one: the blend, which ends at 1, goes there in three strides
RAISE = {"blended": 30.0, "shifted": 10.0}
LEAST = 1e-3  # stiffness added where the convex model has none, over the median diagonal entry
FORCING = 1e-2  # largest relative residual of an iterative solve
IDLE = 10  # iterations in a row that change nothing, after which there is no more to come


class Problem(Protocol):
    """An energy over states that Newton can walk on."""

    @property
    def pattern(self) -> SparsePattern:
        """That of the last Hessian; another object where it has changed, and then the factor has to follow."""

    def energy(self, state: State) -> float: ...

    def gradient(self, state: State) -> Floats:
        """(size,) over the free dofs."""

    def hessian(self, state: State, blend: float) -> Floats:
        """(nnz,) in the pattern; blend 0 is exact, 1 positive semidefinite."""

    def support(self, state: State) -> Ints:
        """Free dofs that, held, stop the rigid motions that nothing else stops, and cause no forces."""

    def path(self, state: State, direction: Floats, straight: bool) -> tuple[Callable[[float], State], float]:
        """Curve of states that leaves `state` in `direction`, and the largest step along it."""


@runtime_checkable
class Coarsened(Protocol):
    """A problem that knows what its Hessian nearly maps to zero."""

    def near_nullspace(self, state: State) -> tuple[Ints, Floats]:
        """Nodes (size,) and modes (size, k) for `Iterative.near_nullspace`."""


@dataclass(frozen=True)
class Iteration:
    """What one iteration reports."""

    number: int
    energy: float
    gradient_norm: float
    blend: float
    step: float


@dataclass
class Minimum:
    """Where Newton stopped, and the evidence.

    `definite`: the exact Hessian (plus `shift`) at the last state, on its support, is positive definite; False too
    if that was not asked for. `idle`: it has not converged, but rounding allows no more.
    """

    state: State
    energy: float
    gradient_norm: float
    converged: bool
    definite: bool
    iterations: int
    factorisations: int
    seconds: dict[str, float] = field(default_factory=dict)
    history: list[Iteration] = field(default_factory=list)
    idle: bool = False


class Clock:
    """Seconds by named part."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def __call__(self, part: str, function: Callable[..., Any], *args: Any) -> Any:
        start = time.perf_counter()
        try:
            return function(*args)
        finally:
            self.seconds[part] = self.seconds.get(part, 0.0) + time.perf_counter() - start


def minimise(
    problem: Problem,
    state: State,
    factor: Factor,
    tolerance: float,
    max_iterations: int = 300,
    method: Method = "blended",
    shift: float = 1e-9,
    report: Callable[[Iteration], None] | None = None,
    blend: float = 0.0,
    verdict: bool = True,
) -> Minimum:
    """Minimise the problem's energy from `state` until the gradient's 2-norm is below `tolerance`.

    `shift` is added to the diagonal of every matrix. `blend` is the first one tried: one that is accepted saves the
    factorisations of those below it. Without `verdict` the last state is not factorised, and `definite` is False.
    """
    clock = Clock()
    history: list[Iteration] = []
    energy = problem.energy(state)
    first = abs(energy)  # terms that cancel at the end keep the rounding of their beginning
    gradient = clock("gradient", problem.gradient, state)
    norm = float(np.linalg.norm(gradient))
    regularise = _Regularisation(problem, factor, method, shift, clock, blend)
    step = 0.0
    stuck = False
    lowest, least, since = energy, norm, 0
    for number in range(max_iterations + 1):
        history.append(Iteration(number, energy, norm, regularise.amount, step))
        if report:
            report(history[-1])
        # steps at the end may lower the energy by less than its rounding, but then the gradient falls
        if energy < lowest - _rounding(energy, first) or norm < 0.9 * least:
            lowest, least, since = min(lowest, energy), min(least, norm), number
        if norm <= tolerance or stuck or number == max_iterations or not np.isfinite(norm) or number >= since + IDLE:
            break
        direction = regularise.direction(state, gradient)
        path, longest = problem.path(state, direction, method == "shifted")
        slope = float(gradient @ direction)
        found = clock("line search", _line_search, problem, path, energy, first, slope, norm, min(1.0, longest))
        if found is None:
            stuck = not regularise.harden()
            continue
        state, energy, step = found
        gradient = clock("gradient", problem.gradient, state)
        norm = float(np.linalg.norm(gradient))
        regularise.relax()
    definite = verdict and regularise.exact(state)
    return Minimum(
        state,
        energy,
        norm,
        norm <= tolerance,
        definite,
        len(history) - 1,
        regularise.count,
        clock.seconds,
        history,
        tolerance < norm and number >= since + IDLE,
    )


class _Regularisation:
    """Makes the matrix positive definite by as little as the factorisation accepts."""

    def __init__(
        self, problem: Problem, factor: Factor, method: Method, shift: float, clock: Clock, blend: float
    ) -> None:
        self.problem, self.factor, self.method, self.shift, self.clock = problem, factor, method, shift, clock
        self.iterative = factor if isinstance(factor, Iterative) else None
        self.amount = blend
        self.raised = False
        self.count = 0
        self.norm = 0.0  # of the last gradient solved for
        self.support: Ints = np.empty(0, dtype=np.int64)

    def direction(self, state: State, gradient: Floats) -> Floats:
        """(size,) the step that a positive definite matrix close to the Hessian gives."""
        if self.iterative and isinstance(self.problem, Coarsened):
            self.iterative.near_nullspace(*self.problem.near_nullspace(state))
        self.support = self.clock("support", self.problem.support, state)
        exact, convex = self._hessian(state, 0.0), None
        diagonal = self.problem.pattern.diagonal  # the pattern may change with the state, so it is asked for after
        # under compression most of the diagonal can be negative
        least = LEAST * float(np.median(np.abs(exact[diagonal])))
        self.raised = False
        while True:
            if self.method == "shifted":
                data = exact.copy()
                data[diagonal] += self.amount
            elif self.amount == 0.0:
                data = exact
            else:
                if convex is None:
                    convex = self._hessian(state, 1.0)
                    # semidefinite is not definite: slack fabric without bending has directions of no stiffness
                    convex[diagonal] += least
                blend = min(self.amount, 1.0)
                data = (1.0 - blend) * exact + blend * convex
                if self.amount > 1.0:
                    data[diagonal] += least * self.amount
            if self._accepts(data):
                try:
                    return -self.clock("solve", self._solve, gradient)
                except NotPositiveDefinite:
                    pass
            if not np.isfinite(data).all():
                raise FloatingPointError("the Hessian is not finite")
            self.raised = True
            self.amount = max(RAISE[self.method] * self.amount, 1e-3)

    def exact(self, state: State) -> bool:
        """Factorise the Hessian itself, for the certificate."""
        self.support = self.clock("support", self.problem.support, state)
        accepted = self._accepts(self._hessian(state, 0.0))
        return accepted and (not self.iterative or self.iterative.proves_definite())

    def relax(self) -> None:
        """After a good step: trust the Hessian more, unless it was refused just now."""
        if not self.raised:
            self.amount = 0.1 * self.amount if self.amount > 1e-3 else 0.0

    def harden(self) -> bool:
        """After a failed line search: a more convex model, while there is one."""
        if self.amount >= (1.0 if self.method == "blended" else 1e12):
            return False
        self.amount = max(10.0 * self.amount, 1e-2)
        return True

    def _hessian(self, state: State, blend: float) -> Floats:
        data = self.clock("hessian", self.problem.hessian, state, blend)
        pattern = self.problem.pattern
        data[pattern.diagonal] += self.shift
        # rigid motions cost nothing, so stopping them changes a step by a rigid motion and the inertia by their zeros
        stiffen(pattern, data, self.support)
        return data

    def _solve(self, gradient: Floats) -> Floats:
        if not self.iterative:
            return self.factor.solve(gradient)
        # inexact at first, and exact enough for quadratic convergence (Eisenstat and Walker 1996, choice 2)
        norm = float(np.linalg.norm(gradient))
        forcing = min(FORCING, 0.9 * (norm / self.norm) ** 2) if self.norm > 0.0 else FORCING
        self.norm = norm
        return self.iterative.solve(gradient, max(forcing, 1e-10))

    def _accepts(self, data: Floats) -> bool:
        self.count += 1
        return bool(self.clock("factorisation", self.factor.factorise, data))


def _rounding(energy: float, first: float) -> float:
    return max(1e-13 * abs(energy), 1e-16 * first)


def _line_search(
    problem: Problem,
    path: Callable[[float], State],
    energy: float,
    first: float,
    slope: float,
    norm: float,
    longest: float,
) -> tuple[State, float, float] | None:
    """Backtrack until the energy falls enough (Armijo); None if it does not for any step worth taking.

    Where the promised decrease drowns in the rounding of the energy, or of the first one (its terms may cancel
    now), a smaller gradient decides.
    """
    a = longest
    rounding = _rounding(energy, first)
    while a > 1e-8:
        state = path(a)
        trial = problem.energy(state)
        if np.isfinite(trial):
            if trial <= energy + 1e-4 * a * slope:
                return state, trial, a
            drowned = abs(a * slope) < 1e3 * rounding and trial <= energy + 1e3 * rounding
            if drowned and np.linalg.norm(problem.gradient(state)) < norm:
                return state, trial, a
        # parabola through the value and slope at 0 and the value at a, kept within a tenth and a half
        curvature = trial - energy - a * slope
        best = -0.5 * slope * a * a / curvature if np.isfinite(curvature) and curvature > 0.0 else 0.1 * a
        a = min(max(best, 0.1 * a), 0.5 * a)
    return None
