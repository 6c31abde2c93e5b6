"""The way to an equilibrium: release, later pins, kicks where stability is lost, certificate."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing

import numpy as np

from discrete.evidence.effort import Effort, PathStep
from discrete.evidence.equilibrium import Equilibrium
from discrete.model.discrete_model import DiscreteModel
from discrete.model.star_bumps import bump_heights
from discrete.model.state import State
from discrete.release.pin_steps import attach_pins, model_with_pins_until
from discrete.release.release_start import ReleaseStart
from discrete.release.saddle import leave_saddle_of_model, lowest_mode
from equilibrium.linear.factor import Factor
from equilibrium.newton.certificate import Eigenpair
from equilibrium.newton.minimise import Iteration, NewtonResult, minimise
from equilibrium.newton.regularisation import Method

Report = Callable[[str, Iteration], None]

EQUILIBRIUM_TOLERANCE = 1e-8  # gradient over the force scale, of the equilibrium
PATH_TOLERANCE = 1e-4  # gradient over the force scale, of the steps before it
WEIGHT_TOLERANCE = 1e-3  # gradient over the norm of the vertex weights: the weight decides how a sheet on needles hangs
# Eigenvalue, over modulus times thickness, below which a state is unstable in spite of the loose path tolerance.
INSTABILITY_THRESHOLD = 1e-7
PROLONGED_BLEND = 1.0  # first blend at a state from another mesh; the factorisation would refuse smaller ones
MAX_PERTURBATIONS = 5  # along negative modes, in each step
PIN_LOAD_STEPS = 5  # for pins that take hold after the release


def prefixed_report(report: Report | None, name: str) -> Report | None:
    """The report with a name before every stage."""
    return (lambda stage, iteration: report(f"{name}, {stage}", iteration)) if report else None


def force_scale(model: DiscreteModel) -> float:
    """N: modulus times fabric thickness times star spacing."""
    fabric = model.design.fabric
    return float(fabric.modulus_mpa * fabric.thickness_mm * model.spacing)


def gradient_tolerance(model: DiscreteModel) -> float:
    """N, the gradient of an equilibrium: a part of the force scale, and of the weight that must hang."""
    part, weight = EQUILIBRIUM_TOLERANCE * force_scale(model), WEIGHT_TOLERANCE * float(np.linalg.norm(model.load))
    return min(part, weight) if weight else part


class ReleaseContinuation:
    """Minimises step by step and keeps count; parameters as in `discrete.release.single_mesh.solve_on_mesh`."""

    def __init__(self, backend: str, method: Method, max_iterations: int, report: Report | None, seed: int) -> None:
        self.backend, self.method, self.max_iterations = backend, method, max_iterations
        self.report, self.seed = report, seed
        self.effort = Effort()

    def follow(self, model: DiscreteModel, start: ReleaseStart) -> Equilibrium:
        """Release the fabric, then let the later pins take hold, one step after the other."""
        *earlier, last = model.layout.pin_steps
        model.set_release(1.0)
        before: tuple[State, bool] | None = None
        for step in earlier:
            present = model_with_pins_until(model, step)
            with self._factor(present) as factor:
                before = self._advance(present, start, before, step, factor), not present.held.any()
        present = model_with_pins_until(model, last)
        with self._factor(present) as factor:
            return self._certify(present, self._advance(present, start, before, last, factor), factor)

    def minimise_from(self, model: DiscreteModel, state: State) -> Equilibrium:
        """Minimise where the model is now."""
        with self._factor(model) as factor:
            return self._certify(model, state, factor, PROLONGED_BLEND)

    def _advance(
        self, model: DiscreteModel, start: ReleaseStart, before: tuple[State, bool] | None, step: int, factor: Factor
    ) -> State:
        """After the step's pins took hold; `before` is where the last step ended, and whether the sheet was free."""
        if before is None:
            return self._release_fabric(model, start, factor)
        return self._move_pins(model, attach_pins(model, *before), step, factor)

    def _release_fabric(self, model: DiscreteModel, start: ReleaseStart, factor: Factor) -> State:
        model.set_release(start.releases[0])
        state = start.initial_state(model)
        for release in start.releases:
            model.set_release(release)
            state = model.apply_supports(state)
            state = start.restore_branches(model, state)
            state = self._follow_step(model, state, 0, factor, f"{100 * release:.0f} %")
        return state

    def _move_pins(self, model: DiscreteModel, state: State, step: int, factor: Factor) -> State:
        for way in np.linspace(0.0, 1.0, PIN_LOAD_STEPS + 1)[1:]:
            model.pin_progress = float(way)
            state = model.apply_supports(state)
            state = self._follow_step(
                model, state, step, factor, f"pins of step {step}, {100 * way:.0f} % of their way"
            )
        return state

    def _follow_step(self, model: DiscreteModel, state: State, step: int, factor: Factor, name: str) -> State:
        """Loosely minimise; where the path has lost its stability, kick it to the side and minimise again."""
        fabric = model.design.fabric
        clear, loose = (
            INSTABILITY_THRESHOLD * fabric.modulus_mpa * fabric.thickness_mm,
            PATH_TOLERANCE * force_scale(model),
        )
        result = self._minimise(model, state, loose, factor, "release", name)
        iterations, kicks = result.iterations, 0
        # the flag also falls for rigid motions, which cost nothing only where all forces vanish
        while kicks < MAX_PERTURBATIONS and not result.definite and np.isfinite(result.energy):
            pair = self._lowest_mode(model, result.state, factor, "stability")
            if pair.value >= -clear - pair.error:
                break
            kicks += 1
            away = leave_saddle_of_model(model, result.state, pair)
            result = self._minimise(model, away, loose, factor, "release", f"{name}, to the side")
            iterations += result.iterations
        here = (step, model.release, model.pin_progress, model.n_vertices)
        self.effort.path.append(PathStep(*here, result.energy, iterations, kicks))
        reached: State = result.state
        return reached

    def _certify(self, model: DiscreteModel, state: State, factor: Factor, blend: float = 0.0) -> Equilibrium:
        """Minimise tightly, find the smallest eigenvalue, and while it is negative leave along its mode."""
        result = self._minimise(model, state, gradient_tolerance(model), factor, "equilibrium", "equilibrium", blend)
        iterations, saddles = result.iterations, 0
        while True:
            pair = self._lowest_mode(model, result.state, factor, "certificate")
            # near a saddle on a fine mesh the gradient may not fall below the tolerance
            if not (result.converged or result.stagnated) or pair.value >= -pair.error or saddles == MAX_PERTURBATIONS:
                break
            saddles += 1
            away = leave_saddle_of_model(model, result.state, pair)
            result = self._minimise(model, away, gradient_tolerance(model), factor, "saddle", "leaving a saddle")
            iterations += result.iterations
        here = (model.layout.pin_steps[-1], model.release, model.pin_progress, model.n_vertices)
        self.effort.path.append(PathStep(*here, result.energy, iterations, saddles))
        return Equilibrium(
            result.state,
            model.energies(result.state),
            result.gradient_norm,
            gradient_tolerance(model),
            pair.value,
            pair.error,
            bump_heights(model, result.state),
            self.effort.iterations,
            self.effort.factorisations,
            saddles,
            factor.name,
            self.effort.clock.seconds,
            tuple(self.effort.path),
        )

    def _factor(self, model: DiscreteModel) -> closing[Factor]:
        return closing(self.effort.clock("analysis", model.factor, self.backend))

    def _lowest_mode(self, model: DiscreteModel, state: State, factor: Factor, stage: str) -> Eigenpair:
        pair = self.effort.clock(stage, lowest_mode, model, state, factor, self.seed)
        self.effort.factorisations += pair.factorisations
        return pair

    def _minimise(
        self,
        model: DiscreteModel,
        state: State,
        goal: float,
        factor: Factor,
        stage: str,
        name: str,
        blend: float = 0.0,
    ) -> NewtonResult:
        """Newton's method on the clock of a stage, to a gradient of `goal` N."""
        report = self.report
        tell = (lambda iteration: report(name, iteration)) if report else None
        result = self.effort.clock(
            stage,
            lambda: minimise(
                model,
                state,
                factor,
                goal,
                self.max_iterations,
                self.method,
                report=tell,
                blend=blend,
                check_definite=stage == "release",  # elsewhere the certificate follows
            ),
        )
        self.effort.add(result)
        return result
