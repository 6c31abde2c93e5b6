"""Continuation from the print to a certified equilibrium, on one mesh.

Stages: release of the fabric in steps; pins that take hold later; a perturbation along the negative mode wherever the
path becomes unstable; final minimisation and certificate.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace

import numpy as np

from asterism.discrete.model.contact_model import is_intersection_free
from asterism.discrete.model.discrete_model import DiscreteModel, bump_heights
from asterism.discrete.model.state import State
from asterism.discrete.release.equilibrium import Equilibrium, PathStep
from asterism.discrete.release.release_start import ReleaseStart, spacing_ratio, start_of_design
from asterism.discrete.release.unfold import unfolded
from asterism.equilibrium.clock import Clock
from asterism.equilibrium.linear.factor import Factor, IterativeFactor
from asterism.equilibrium.newton.certificate import Eigenpair, leave_saddle, smallest_eigenvalue
from asterism.equilibrium.newton.minimise import Iteration, Minimum, minimise
from asterism.pattern.geometry.rigid_fit import rigid_fit

Report = Callable[[str, Iteration], None]
# iterations of all minimisations on one mesh: designs of the study take 60 to 220, contact takes 463; then the search
# ends with its last state, which is the lowest
MAX_RELEASE_ITERATIONS = 3000
MAX_ITERATIONS = 500  # of each minimisation
# perturbations along negative modes in each step
MAX_PERTURBATIONS = 5


def prefixed_report(report: Report | None, name: str) -> Report | None:
    """The report with a prefix to the name of every stage."""
    return (lambda stage, iteration: report(f"{name}, {stage}", iteration)) if report else None


def force_scale(model: DiscreteModel) -> float:
    """N, modulus times thickness of the fabric times spacing of the stars: the scale of membrane forces."""
    fabric = model.design.fabric
    return float(fabric.modulus * fabric.thickness_mm * model.spacing)


def gradient_tolerance(model: DiscreteModel) -> float:
    """N, largest gradient norm of an equilibrium, relative to the force scale and to the weight."""
    # the weight alone decides how a stiff sheet on needles hangs
    elastic, weight = 1e-8 * force_scale(model), 1e-3 * float(np.linalg.norm(model.load))
    return min(elastic, weight) if weight else elastic


def solve_on_mesh(
    model: DiscreteModel,
    start: ReleaseStart | State | Equilibrium | None = None,
    backend: str = "auto",
    report: Report | None = None,
    coarse: bool = False,
) -> Equilibrium:
    """Find an equilibrium of a model and certify it.

    Raises `ValueError` if a given state intersects itself, and the model has contact.

    Parameters
    ----------
    model : the model; it is fully released at the end, also after an exception.
    start : a `ReleaseStart`, by default that of the design. A state, such as one from another mesh, is minimised at
        full release with all pins in place; so is an equilibrium of a search with `coarse`, which is near its end.
    backend : linear solver, see `equilibrium.linear.backends`.
    report : called after every iteration with the name of the stage.
    coarse : a finer mesh follows. The result is only as accurate as it needs, and usually has no certificate.

    A single star without rest curvature of its arms, as coarse as it can be meshed:

    >>> from asterism.pattern import gallery
    >>> from asterism.pattern.layout.build import layout
    >>> from asterism.pattern.mesh.meshing import mesh_layout
    >>> design = gallery.load("star")
    >>> plan = layout(design)
    >>> model = DiscreteModel(design, plan, mesh_layout(plan, 6.0))
    >>> equilibrium = solve_on_mesh(model, ReleaseStart(releases=(0.3, 1.0)), backend="superlu")
    >>> equilibrium.is_minimum, equilibrium.stars_up, [step.release for step in equilibrium.path]
    (True, 1, [0.3, 1.0, 1.0])
    """
    continuation = _Continuation(backend, report, coarse)
    if isinstance(start, Equilibrium):
        return continuation.minimise_from(model, start.state, 0.0)
    if isinstance(start, State):
        model.set_release(1.0)
        state = model.apply_supports(start)
        if not is_intersection_free(model, state):
            raise ValueError("start: the state passes through itself; contact cannot separate intersecting parts")
        # the first blend of the Hessian is 1: the factorisation would refuse smaller ones
        return continuation.minimise_from(model, unfolded(model, state), 1.0)
    try:
        return continuation.follow(model, start or start_of_design(model.design))
    except BaseException:
        model.set_release(1.0)  # also after an interruption
        raise


class _Continuation:
    """Minimises step by step and counts the effort; parameters as in `solve_on_mesh`."""

    def __init__(self, backend: str, report: Report | None, coarse: bool) -> None:
        self.backend, self.report, self.coarse = backend, report, coarse
        self.iterations = self.factorisations = 0
        self.clock = Clock()
        self.path: list[PathStep] = []
        # of the Hessian at the beginning of the next step of the path, as the step before needed it
        self.blend = 0.0

    def follow(self, model: DiscreteModel, start: ReleaseStart) -> Equilibrium:
        """Release the fabric from a start, then attach the later pins step by step, and certify the result."""
        model.set_release(1.0)
        state: State | None = None
        was_free = False
        for step in model.layout.pin_steps:
            present = model_with_pins_until(model, step)
            with self._factor(present) as factor:
                if state is None:
                    state = self._release_fabric(present, start, factor)
                else:
                    state = self._move_pins(present, _attach_pins(present, state, was_free), step, factor)
                if step == model.layout.pin_steps[-1]:
                    return self._certify(present, state, factor)
            was_free = not present.held.any()
        raise AssertionError("the release is a step")

    def minimise_from(self, model: DiscreteModel, state: State, blend: float) -> Equilibrium:
        """Minimise from a state at the present release of the model, and certify the result."""
        with self._factor(model) as factor:
            return self._certify(model, state, factor, blend)

    def _release_fabric(self, model: DiscreteModel, start: ReleaseStart, factor: Factor) -> State:
        model.set_release(start.releases[0])
        state = start.initial_state(model)
        for release in start.releases:
            model.set_release(release)
            state = model.apply_supports(state)
            state = unfolded(model, start.restore_branches(model, state))
            state = self._follow_step(model, state, 0, factor, f"{100 * release:.0f} %")
        return state

    def _move_pins(self, model: DiscreteModel, state: State, step: int, factor: Factor) -> State:
        for progress in np.linspace(0.0, 1.0, 6)[1:]:
            model.pin_progress = float(progress)
            state = unfolded(model, model.apply_supports(state))
            name = f"pins of step {step}, {100 * progress:.0f} % of their way"
            state = self._follow_step(model, state, step, factor, name)
        return state

    def _follow_step(self, model: DiscreteModel, state: State, step: int, factor: Factor, name: str) -> State:
        """Minimise to the path tolerance; perturb an unstable state along its negative mode and minimise again."""
        fabric = model.design.fabric
        # N/mm, negative eigenvalue beyond which a loosely converged state counts as unstable
        threshold = 1e-7 * fabric.modulus * fabric.thickness_mm
        tolerance = 1e-4 * force_scale(model)
        result = self._minimise(model, state, tolerance, factor, "release", name, self.blend)
        self.blend = result.blend
        iterations, kicks = result.iterations, 0
        # `definite` may also be False because of rigid motions, which have zero energy only if all forces vanish
        while kicks < MAX_PERTURBATIONS and not result.definite and np.isfinite(result.energy):
            pair = self._lowest_mode(model, result.state, factor, "stability")
            if pair.value >= -threshold - pair.error:
                break
            kicks += 1
            perturbed = _leave_saddle_of_model(model, result.state, pair)
            result = self._minimise(model, perturbed, tolerance, factor, "release", f"{name}, off a saddle")
            iterations += result.iterations
        place = (step, model.release, model.pin_progress, model.n_vertices)
        self.path.append(PathStep(*place, result.energy, iterations, kicks))
        end: State = result.state
        return end

    def _certify(self, model: DiscreteModel, state: State, factor: Factor, blend: float = 0.0) -> Equilibrium:
        """Minimise to the final tolerance; while the smallest eigenvalue is negative, leave the saddle and repeat.

        On a coarse mesh, the factorisation of the last step is evidence enough.
        """
        tolerance = gradient_tolerance(model)
        result = self._minimise(model, state, tolerance, factor, "equilibrium", "equilibrium", blend)
        iterations, saddles = result.iterations, 0
        lowest, error = math.nan, math.nan
        while not (self.coarse and result.settled):
            pair = self._lowest_mode(model, result.state, factor, "certificate")
            lowest, error = pair.value, pair.error
            is_saddle = lowest < -error and saddles < MAX_PERTURBATIONS
            # near a saddle on a fine mesh the gradient may stay above the tolerance
            if is_saddle and (result.converged or result.stagnated or result.near_saddle):
                saddles += 1
                perturbed = _leave_saddle_of_model(model, result.state, pair)
                result = self._minimise(model, perturbed, tolerance, factor, "saddle", "leaving a saddle")
            elif result.near_saddle:
                result = self._minimise(
                    model, result.state, tolerance, factor, "equilibrium", "equilibrium", seek_saddle=False
                )
            else:
                break
            iterations += result.iterations
        place = (model.layout.pin_steps[-1], model.release, model.pin_progress, model.n_vertices)
        self.path.append(PathStep(*place, result.energy, iterations, saddles))
        return Equilibrium(
            result.state,
            model.energies(result.state),
            result.gradient_norm,
            gradient_tolerance(model),
            lowest,
            error,
            bump_heights(model, result.state),
            self.iterations,
            self.factorisations,
            saddles,
            factor.name,
            self.clock.seconds,
            tuple(self.path),
        )

    def _factor(self, model: DiscreteModel) -> closing[Factor]:
        with self.clock("analysis"):
            return closing(model.factor(self.backend))

    def _lowest_mode(self, model: DiscreteModel, state: State, factor: Factor, stage: str) -> Eigenpair:
        """Smallest eigenvalue of the exact Hessian and its mode, without the rigid motions."""
        with self.clock(stage):
            data = model.hessian(state, 0.0)
            if isinstance(factor, IterativeFactor):
                factor.set_near_nullspace(*model.near_nullspace(state))
            modes, seed = model.rigid_modes(state), model.design.solver.seed
            pair = smallest_eigenvalue(model.pattern, data, factor, modes, seed)
        self.factorisations += pair.factorisations
        return pair

    def _minimise(
        self,
        model: DiscreteModel,
        state: State,
        tolerance: float,
        factor: Factor,
        stage: str,
        name: str,
        blend: float = 0.0,
        seek_saddle: bool = True,
    ) -> Minimum:
        """Newton's method to a gradient norm of `tolerance` N, timed as `stage` and reported as `name`."""
        report, energies = self.report, model.energies(state)
        # of the elastic energy: such a decrease ends a step of the path, or the search on a coarse mesh
        fraction = 1e-4 if stage == "release" else 1e-7 if self.coarse else 0.0
        # without iterations, a minimisation returns its state, and the certificate says that it is no equilibrium
        left = max(MAX_RELEASE_ITERATIONS - self.iterations, 0)
        stage_report = (lambda iteration: report(name, iteration)) if report else None
        elastic = sum(energies.values()) - energies.get("gravity", 0.0)
        with self.clock(stage):
            result = minimise(
                model,
                state,
                factor,
                tolerance,
                min(MAX_ITERATIONS, left),
                report=stage_report,
                blend=blend,
                check_definite=stage == "release",  # at the end the certificate decides
                small_decrease=fraction * elastic,
                saddle_decrease=1e-6 * elastic if seek_saddle else 0.0,
            )
        self.iterations += result.iterations
        self.factorisations += result.factorisations
        return result


def model_with_pins_until(model: DiscreteModel, step: int) -> DiscreteModel:
    """The model with the pins of the steps up to `step`; the model itself if all its pins act from the print on."""
    if model.layout.pin_steps == (0,):
        return model
    kept = [i for i, pin in enumerate(model.layout.pins) if pin.is_active(step)]
    if len(kept) == len(model.layout.pins):
        return copy.copy(model)  # `_attach_pins` replaces the constraints of the copy
    layout = replace(model.layout, pins=tuple(model.layout.pins[i] for i in kept))
    mesh = replace(model.mesh, pin_vertices=tuple(model.mesh.pin_vertices[i] for i in kept))
    return type(model)(model.design, layout, mesh)


def _attach_pins(model: DiscreteModel, state: State, was_free: bool) -> State:
    """Attach the pins of the model to a state. From there they move to their targets with `model.pin_progress`.

    A sheet without supports (`was_free`) first moves rigidly to where its pins are nearest to their targets.
    """
    model.set_release(1.0)
    if was_free:
        state = _fitted_to_pins(model, state)
    start = np.where(model.constraints.held, state.positions, model.constraints.printed)
    model.constraints = replace(model.constraints, printed=start)
    model.pin_progress = 0.0
    return state


def _fitted_to_pins(model: DiscreteModel, state: State) -> State:
    """The state moved rigidly so that the vertices with most held components are closest to their targets (Kabsch).

    If the pins leave a rotation undetermined, the printed positions of the other vertices decide: the plastic is up.
    """
    components = model.constraints.held.sum(axis=1)
    fitted = components == components.max()
    # the free vertices decide a rotation that the pins leave undetermined
    weight = np.where(fitted, 1.0 / fitted.sum(), 1e-6 / model.n_vertices)
    rotation, shift = rigid_fit(state.positions, model.constraints.target, weight)
    return state.rotated(rotation, shift)


def _leave_saddle_of_model(model: DiscreteModel, state: State, pair: Eigenpair) -> State:
    """The state moved along a negative mode to its lower side, while the energy falls and no further than the limit."""
    # 2 mm at the paper's spacing of the stars, and in proportion at others
    lower: State = leave_saddle(model, state, pair.vector, spacing_ratio(model) * 2.0)
    return lower
