"""From the print to a certified equilibrium: start, continuation in the stretch, certificate, way out of saddles."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from discrete.elements import Array
from discrete.model import Model
from discrete.stars import bump_heights, bumped
from discrete.state import State, carried
from equilibrium.certificate import Eigenpair, smallest_eigenvalue
from equilibrium.factor import Factor, make_factor
from equilibrium.newton import Iteration, Method, Minimum, minimise

Start = Literal["bump", "flat"]
Report = Callable[[str, Iteration], None]

BUMP_MM = 2.0
FLAT_MM = 0.1
NUDGE_MM = 0.5
NOISE_MM = 1e-3
RELEASES = tuple(np.linspace(0.03, 1.0, 10))


@dataclass(frozen=True)
class Equilibrium:
    """A state of the exact model with the evidence for what it is.

    Attributes
    ----------
    state : positions and directors.
    energies : N mm, by part.
    gradient_norm : 2-norm over the free dofs, N.
    tolerance : that `converged` compares it with.
    smallest_eigenvalue : of the Hessian in (mm, rad) coordinates without its rigid motions, N/mm; `eigenvalue_error`
        is the norm of its residual.
    bumps : (S,) mm, positive for stars that bump to the plastic side.
    seconds : wall time by stage.
    """

    state: State
    energies: dict[str, float]
    gradient_norm: float
    tolerance: float
    smallest_eigenvalue: float
    eigenvalue_error: float
    bumps: Array
    iterations: int
    factorisations: int
    saddles_left: int
    backend: str
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def energy(self) -> float:
        """N mm."""
        return sum(self.energies.values())

    @property
    def converged(self) -> bool:
        """The gradient is below the tolerance."""
        return self.gradient_norm <= self.tolerance

    @property
    def is_minimum(self) -> bool:
        """Converged, and every eigenvalue is positive beyond the error of the smallest."""
        return self.converged and self.smallest_eigenvalue > self.eigenvalue_error

    @property
    def stars_up(self) -> int:
        """Stars that bump to the plastic side."""
        return int((self.bumps > 0.0).sum())


def relax(
    model: Model,
    start: Start | State = "bump",
    releases: Sequence[float] = RELEASES,
    seed: int = 0,
    backend: str = "auto",
    method: Method = "blended",
    max_iterations: int = 500,
    report: Report | None = None,
) -> Equilibrium:
    """Equilibrium of a model.

    Parameters
    ----------
    start : `bump`: every star starts 2 mm up, the branch that printing on the plastic side favours, and is nudged
        between the steps while it is still flat; `flat`: as printed; or a state, minimised at full release.
    releases : steps of the continuation; the last must be 1.
    seed : of the noise (a thousandth of a mm) that takes an exactly symmetric start off its symmetry.
    backend : sparse factorisation, see `equilibrium.factor`.
    report : called after every iteration with the stage's name.
    """
    clock = _Stages()
    factor = clock.run("analysis", lambda: make_factor(model.pattern, backend))
    try:
        tolerance = 1e-8 * force_scale(model)
        total = _Count()
        if isinstance(start, State):
            state, releases = start, (1.0,)
        else:
            state = _first_state(model, start, releases[0], seed)
        result: Minimum | None = None
        for release in releases:
            last = release == releases[-1]
            model.set_release(release)
            state = model.moved_pins(state)
            if start == "bump" and not last:
                state = _kept_up(model, state)
            stage = "equilibrium" if last else "release"
            goal = tolerance if last else 1e-4 * force_scale(model)
            result = clock.run(
                stage, _minimise, model, state, factor, goal, max_iterations, method, report, f"{100 * release:.0f} %"
            )
            total.add(result)
            state = result.state
        assert result is not None
        return _certified(model, result, factor, tolerance, max_iterations, method, report, clock, total, seed)
    finally:
        factor.close()


def force_scale(model: Model) -> float:
    """N: modulus times fabric thickness times star spacing."""
    fabric = model.design.fabric
    return float(fabric.modulus_mpa * fabric.thickness_mm * model.spacing)


def _first_state(model: Model, start: Start, release: float, seed: int) -> State:
    model.set_release(release)
    state = model.flat_state()
    if start == "bump":
        state = bumped(model, state, BUMP_MM)
    noise = NOISE_MM * np.random.default_rng(seed).standard_normal(state.positions.shape)
    positions = state.positions + np.where(model.constraints.held, 0.0, noise)
    return carried(state, model.network.edges, positions, np.zeros(len(model.network.edges)))


def _kept_up(model: Model, state: State) -> State:
    """Early in the release a star is nearly flat and goes where rounding sends it: bump those that are not up."""
    return bumped(model, state, NUDGE_MM, np.flatnonzero(bump_heights(model, state) < FLAT_MM))


def _minimise(
    model: Model,
    state: State,
    factor: Factor,
    tolerance: float,
    max_iterations: int,
    method: Method,
    report: Report | None,
    name: str,
) -> Minimum:
    tell = (lambda iteration: report(name, iteration)) if report else None
    return minimise(model, state, factor, tolerance, max_iterations, method, report=tell)


def _certified(
    model: Model,
    result: Minimum,
    factor: Factor,
    tolerance: float,
    max_iterations: int,
    method: Method,
    report: Report | None,
    clock: _Stages,
    total: _Count,
    seed: int,
    attempts: int = 5,
) -> Equilibrium:
    """The smallest eigenvalue; while it is negative, leave along its mode and minimise again."""
    left = 0
    while True:
        pair = clock.run("certificate", _eigenpair, model, result.state, factor, seed)
        total.factorisations += pair.factorisations
        if not result.converged or pair.value > -pair.error or left == attempts:
            break
        left += 1
        away = _leave(model, result.state, pair)
        result = clock.run(
            "saddle", _minimise, model, away, factor, tolerance, max_iterations, method, report, "leaving a saddle"
        )
        total.add(result)
    return Equilibrium(
        result.state,
        model.energies(result.state),
        result.gradient_norm,
        tolerance,
        pair.value,
        pair.error,
        bump_heights(model, result.state),
        total.iterations,
        total.factorisations,
        left,
        factor.name,
        clock.seconds,
    )


def _eigenpair(model: Model, state: State, factor: Factor, seed: int) -> Eigenpair:
    data = model.hessian(state, 0.0)
    return smallest_eigenvalue(model.pattern, data, factor, model.rigid_modes(state), seed=seed)


def _leave(model: Model, state: State, pair: Eigenpair) -> State:
    """Go down along the negative mode, on the side and as far as the energy falls, largest move 2 mm."""
    best, lowest = state, model.energy(state)
    for sign in (1.0, -1.0):
        path, longest = model.path(state, sign * pair.vector)
        step = min(longest, 2.0 / float(np.abs(pair.vector).max()))
        for _ in range(12):
            trial = path(step)
            energy = model.energy(trial)
            if energy < lowest:
                best, lowest = trial, energy
            step *= 0.5
    return best


class _Stages:
    """Wall time by stage."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    def run(self, stage: str, function: Callable, *args: object):  # type: ignore[no-untyped-def, type-arg]
        start = time.perf_counter()
        try:
            return function(*args)
        finally:
            self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - start


class _Count:
    """Work done so far."""

    def __init__(self) -> None:
        self.iterations = 0
        self.factorisations = 0

    def add(self, result: Minimum) -> None:
        self.iterations += result.iterations
        self.factorisations += result.factorisations
