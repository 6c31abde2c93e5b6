"""The fit: bounded Levenberg-Marquardt steps on the star sizes through the preview.

The preview follows each step from its last equilibrium. A step counts only if the new equilibrium is a minimum, lies
near its linear prediction, and is nearer to the target. Every third step a fresh preview starts from initial guesses:
where it takes another form, the fit goes on from that form. Only what a fresh preview confirms is returned.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.fitting.residual import Residual, SheetState
from asterism.fitting.star_unknowns import StarUnknowns
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from asterism.previews.solve import EDIT_START
from asterism.previews.star_sensitivity import star_sensitivity
from asterism.process.listeners import Say, ignore_line
from asterism.shape.shape import Shape

# steps of the smooth changes, and of all stars
MAX_SMOOTH_STEPS, MAX_STAR_STEPS = 3, 12
# steps between two fresh previews
FRESH_EVERY = 3
# mm per unit: weight of the differences between neighbours, and of the changes themselves, from the first guess on
NEIGHBOUR_WEIGHT, CHANGE_WEIGHT = 0.12, 0.01
# damping of the first step relative to the largest diagonal entry, its factors after success and failure, and limits
FIRST_DAMPING, DAMPING_AFTER_SUCCESS, DAMPING_AFTER_FAILURE = 1e-3, 0.3, 8.0
MIN_DAMPING, MAX_DAMPING = 1e-9, 1e3
# share of the predicted decrease that a step must reach
MIN_DECREASE_SHARE = 0.1
# relative decrease of the rms distance below which the fit ends
MIN_FIT_GAIN = 0.02
# distance of the equilibrium from its linear prediction over the length of the step, and mm that always pass
MAX_PREDICTION_MISS, FREE_MISS_MM = 0.8, 0.1
# a fresh preview has another form if its rms distance differs by more than this share, and by more than so many mm
MAX_FRESH_CHANGE, FRESH_TOLERANCE_MM = 0.1, 0.02
# largest change of an unknown in one step
LONGEST_STEP = 2.5

# words for the kinds of steps
STEP_WORDS = {"smooth": "all stars together", "stars": "each star", "fresh": "fresh preview"}


@dataclass(eq=False)
class FitSearch:
    """The state of a fit of the star sizes `unknowns` of the design `base`; `steps` are those of a `FitRecord`."""

    base: Design
    law: StarLaw
    residual: Residual
    diameter_mm: float
    unknowns: StarUnknowns
    say: Say = ignore_line
    steps: list[dict[str, Any]] = field(default_factory=list)
    restarts: int = 0

    def __post_init__(self) -> None:
        self.start = self.unknowns
        self.preview = Preview(self.unknowns.design(self.base), self.law)
        self.state = self.residual.at(self.preview)
        self.best, self.best_rms = self.unknowns, self.state.rms_mm
        self._is_fresh = True
        self._damping = FIRST_DAMPING
        self._varies = np.ones(len(self.unknowns.units), dtype=bool)
        self._record("fresh")

    def run(self) -> None:
        """Fit smooth changes, then each star; `best` is what fresh previews confirm."""
        self._stage("smooth", MAX_SMOOTH_STEPS, self.start.smooth_basis())
        self._stage("stars", MAX_STAR_STEPS, None)

    def again(self, base: Design, sizes: StarUnknowns, start: StarUnknowns, steps: int) -> StarUnknowns:
        """Fit each star again from sizes, and return the best ones; lengths only if the design rounds thicknesses.

        Changes count from the sizes `start`.
        """
        self.base, self.start, self._damping = base, start, FIRST_DAMPING
        self.unknowns = self.best = sizes
        if base.required_stars.rounding is not None:
            self._varies = np.arange(len(sizes.units)) < len(sizes.lengths_mm)
        self._renew()
        self.best_rms = self.state.rms_mm
        self._record("fresh")
        self._stage("stars", steps, None)
        return self.best

    def aim(self, base: Design, sizes: StarUnknowns, exact: Shape) -> None:
        """Count the residuals of previews by those of an exact shape: at its sizes both are equal."""
        self.base, self.unknowns, self.residual.offset = base, sizes, 0.0
        self._renew()
        self.residual.offset = self.residual.of_exact(exact).values - self.state.values

    def _stage(self, kind: str, count: int, basis: Floats | None) -> None:
        taken = 0
        while taken < count:
            before = self.state.rms_mm
            if not self._step(basis):
                break
            taken += 1
            self._record(kind)
            has_small_gain = self.state.rms_mm > (1.0 - MIN_FIT_GAIN) * before
            if (taken % FRESH_EVERY == 0 or taken == count or has_small_gain) and not self._confirm():
                continue
            if has_small_gain:
                break
        self._confirm()
        if self.unknowns is not self.best:
            self.unknowns = self.best
            self._renew()

    def _record(self, kind: str) -> None:
        percent = 100.0 * self.state.rms_mm / self.diameter_mm
        self.steps.append({"kind": kind, "rms_percent": percent})
        self.say(f"step {len(self.steps) - 1}, {STEP_WORDS[kind]}: {percent:.2f} % of the diameter")

    def _confirm(self) -> bool:
        """Whether a fresh preview has the followed form; if not, the fit goes on from the fresh one."""
        if self._is_fresh:
            return True
        followed = self.state.rms_mm
        self._renew()
        fresh = self.state.rms_mm
        if fresh < self.best_rms:
            self.best, self.best_rms = self.unknowns, fresh
        if abs(fresh - followed) <= max(MAX_FRESH_CHANGE * followed, FRESH_TOLERANCE_MM):
            return True
        self.restarts += 1
        self._record("fresh")
        return False

    def _renew(self) -> None:
        """Search for the equilibrium of the present sizes from initial guesses, as a new preview does."""
        design = self.unknowns.design(self.base)
        if design != self.preview.design:
            next(self.preview.edit(design))
        self.preview.search_again()
        self.state, self._is_fresh = self.residual.at(self.preview), True

    def _step(self, basis: Floats | None) -> bool:
        """Take one step; False if none is accepted."""
        jacobian = self._jacobian()
        rough = self.start.roughness()
        change = self.unknowns.difference(self.start)
        count = len(change)
        weight = NEIGHBOUR_WEIGHT**2 * rough.toarray() + CHANGE_WEIGHT**2 / count * np.eye(count)
        normal = jacobian.T @ jacobian + weight
        gradient = jacobian.T @ self.state.values + weight @ change
        scale = float(np.diag(normal).max())
        cost = self._cost(self.state, self.unknowns, weight)
        low, high = self._bounds()
        before, state_before, unknowns_before = self.preview.snapshot(), self.state, self.unknowns
        while self._damping <= MAX_DAMPING:
            damped = normal + self._damping * scale * np.eye(count)
            if basis is None:
                step = _bounded_step(damped, gradient, low, high)
            else:
                step = basis @ np.linalg.solve(basis.T @ damped @ basis, -basis.T @ gradient)
                step = np.clip(step, low, high)
            predicted = -(gradient @ step + 0.5 * step @ normal @ step)
            if predicted > 0.0 and self._try(step, cost, predicted, weight):
                self._damping = max(self._damping * DAMPING_AFTER_SUCCESS, MIN_DAMPING)
                return True
            self.preview.restore(before)
            self.state, self.unknowns = state_before, unknowns_before
            self._damping *= DAMPING_AFTER_FAILURE
        self._damping = FIRST_DAMPING
        return False

    def _bounds(self) -> tuple[Floats, Floats]:
        low, high = self.unknowns.bounds
        low, high = np.maximum(low, -LONGEST_STEP), np.minimum(high, LONGEST_STEP)
        return np.where(self._varies, low, 0.0), np.where(self._varies, high, 0.0)

    def _cost(self, state: SheetState, unknowns: StarUnknowns, weight: Floats) -> float:
        change = unknowns.difference(self.start)
        return 0.5 * float(state.values @ state.values + change @ weight @ change)

    def _try(self, step: Floats, cost: float, predicted: float, weight: Floats) -> bool:
        """Whether the preview follows a step to a minimum that is near its prediction and nearer to the target."""
        moved = self.unknowns.moved(step)
        places_before = self.state.places
        try:
            stages = list(self.preview.edit(moved.design(self.base)))
        except Error:
            return False
        equilibrium = self.preview.equilibrium
        if len(stages) < 2 or equilibrium.guess != EDIT_START or not equilibrium.is_minimum:
            return False
        state = self.residual.at(self.preview)
        linear = self.residual.at(self.preview, stages[0].x).places
        miss = _rms(state.places - linear)
        if miss > max(MAX_PREDICTION_MISS * _rms(linear - places_before), FREE_MISS_MM):
            return False
        if cost - self._cost(state, moved, weight) < MIN_DECREASE_SHARE * predicted:
            return False
        self.state, self.unknowns, self._is_fresh = state, moved, False
        return True

    def _jacobian(self) -> Floats:
        """(3 n, 2 S) derivatives of the residuals by the unknowns."""
        count, columns = len(self.unknowns.lengths_mm), []
        for number, name in enumerate(("length_mm", "thickness_mm")):
            if self._varies[number * count]:
                responses = star_sensitivity(self.preview.state, name)  # type: ignore[arg-type]
                columns.append(self.residual.derivatives(self.preview, self.state, responses))
            else:
                columns.append(np.zeros((len(self.state.values), count)))
        return np.hstack(columns) * self.unknowns.units


def _rms(moves: Floats) -> float:
    return float(np.sqrt((moves**2).sum(axis=1).mean()))


def _bounded_step(normal: Floats, gradient: Floats, low: Floats, high: Floats) -> Floats:
    """(P,) the step s that minimises `s N s / 2 + g s` within `low <= s <= high`; N is positive definite."""
    step, varies = np.zeros(len(gradient)), low < high
    root = np.linalg.cholesky(normal[np.ix_(varies, varies)])
    right = solve_triangular(root, -gradient[varies], lower=True)
    step[varies] = lsq_linear(root.T, right, (low[varies], high[varies]), method="bvls").x
    return step
