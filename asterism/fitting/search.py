"""The fit: bounded Levenberg-Marquardt steps on the star sizes through the preview, then exact corrections.

The preview follows each step from its last equilibrium. A step counts only if the new equilibrium is a minimum, lies
near its linear prediction, and is nearer to the target. Every third step a fresh preview starts from initial guesses:
where it takes another form, the fit goes on from that form. Only what a fresh preview confirms is returned.

The exact shape of fitted sizes misses the target by the error of the preview, and this error changes little with the
sizes. Its residuals are therefore added to those of the preview, and the fit by the preview goes on from there (defect
correction: Stetter 1978, The defect correction principle and discretization methods). What it converges to has exact
residuals. A correction takes one exact shape, which follows from the last one, and no derivatives of the exact model.
A step counts only if the new exact shape is a certified minimum and nearer to the target; otherwise a part of it is
tried. Steps begin small and grow with success, since far from its sizes the error of the preview is another one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import scipy.sparse as sp
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from asterism.discrete.release.continuation import Report
from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.exact.simulation import exact_shape
from asterism.fitting.first_guess import FITTED_SIZE_DECIMALS
from asterism.fitting.reach import StarMenu
from asterism.fitting.residual import FitDistance, Residual, SheetState
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import with_painted_stars
from asterism.previews.session import Preview
from asterism.previews.solve import EDIT_START
from asterism.previews.star_sensitivity import star_sensitivity
from asterism.process.listeners import Say, ignore_line
from asterism.shape.shape import Shape

# an unknown of 1 is a change of a length by 1 mm, or of the logarithm of a thickness by this number
THICKNESS_UNIT = 0.15


@dataclass(frozen=True, eq=False)
class StarUnknowns:
    """Length and thickness of S stars as one vector, and its bounds.

    Attributes
    ----------
    plan : of the print.
    menu : sizes that the law covers.
    values : (2 S,) lengths in mm, then logarithms of thicknesses in mm over `THICKNESS_UNIT`.
    """

    plan: Layout
    menu: StarMenu
    values: Floats

    @classmethod
    def of(cls, plan: Layout, menu: StarMenu) -> StarUnknowns:
        """The unknowns of a layout."""
        lengths, thicknesses = plan.star_sizes_mm[:, :2].T
        return cls(plan, menu, np.concatenate([lengths, np.log(thicknesses) / THICKNESS_UNIT]))

    @cached_property
    def sizes_mm(self) -> Floats:
        """(S, 2) lengths and thicknesses."""
        lengths, logarithms = np.split(self.values, 2)
        return np.column_stack([lengths, np.exp(THICKNESS_UNIT * logarithms)])

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """(2 S,) smallest and largest change of the unknowns."""
        menu, lengths = self.menu, self.sizes_mm[:, 0]
        least = menu.least_thickness(lengths), np.full(len(lengths), menu.thicknesses_mm[-1])
        low, high = (
            np.concatenate([np.full(len(lengths), end), np.log(thickness) / THICKNESS_UNIT]) - self.values
            for end, thickness in zip(menu.lengths_mm[[0, -1]], least, strict=True)
        )
        return np.minimum(low, 0.0), np.maximum(high, 0.0)

    @property
    def share_at_bounds(self) -> float:
        """Share of the stars whose length is the smallest or the largest one."""
        (low, high), lengths = self.menu.lengths_mm[[0, -1]], self.sizes_mm[:, 0]
        return float(((lengths <= low + 1e-6) | (lengths >= high - 1e-6)).mean())

    @property
    def units(self) -> Floats:
        """(2 S,) mm, change of each size for a change of its unknown by 1."""
        return np.concatenate([np.ones(len(self.sizes_mm)), THICKNESS_UNIT * self.sizes_mm[:, 1]])

    def moved(self, step: Floats) -> StarUnknowns:
        """The unknowns after a step (2 S,), with lengths of the menu, and thicknesses up to its largest one."""
        menu, (lengths, logarithms) = self.menu, np.split(self.values + step, 2)
        thickest = np.log(menu.thicknesses_mm[-1]) / THICKNESS_UNIT
        lengths = np.clip(lengths, menu.lengths_mm[0], menu.lengths_mm[-1])
        return replace(self, values=np.concatenate([lengths, np.minimum(logarithms, thickest)]))

    def length_change(self, start: StarUnknowns) -> float:
        """mm, largest change of a length from a start."""
        return float(np.abs(self.sizes_mm[:, 0] - start.sizes_mm[:, 0]).max())

    def design(self, base: Design) -> Design:
        """A design with these sizes."""
        sizes = self.sizes_mm.round(FITTED_SIZE_DECIMALS)
        return with_painted_stars(base, self.plan.sites, np.column_stack([sizes, np.full(len(sizes), np.nan)]))

    def roughness(self) -> sp.csr_array:
        """(2 S, 2 S) matrix R with `z R z` the mean square difference of the unknowns z of neighbouring stars."""
        pairs, count = self.plan.sample_pairs, len(self.sizes_mm)
        rows, signs = np.repeat(np.arange(len(pairs)), 2), np.tile([1.0, -1.0], len(pairs))
        ends = sp.coo_array((signs, (rows, pairs.ravel())), shape=(len(pairs), count)).tocsr()
        of_one_size = ends.T @ ends / max(len(pairs), 1)
        return sp.csr_array(sp.block_diag([of_one_size, of_one_size]))

    def smooth_basis(self) -> Floats:
        """(2 S, m) orthonormal smooth changes: polynomials of the printed coordinates, of degree 2 and 1."""
        centres = self.plan.centres - self.plan.centres.mean(axis=0)
        x, y = (centres / np.abs(centres).max()).T
        powers = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y])
        return np.asarray(sp.block_diag([np.linalg.qr(powers[:, :count])[0] for count in (6, 3)]).toarray())


# damping of the first step relative to the largest diagonal entry
FIRST_DAMPING = 1e-3
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
        self._lens = self.preview.lens(self.residual.places.points)
        self.state = self.residual.at(self._lens())
        self.best, self.best_rms = self.unknowns, self.state.rms_mm
        self._is_fresh = True
        self._damping = FIRST_DAMPING
        self._varies = np.ones(len(self.unknowns.units), dtype=bool)
        self._record("fresh")

    def run(self) -> None:
        """Fit smooth changes, then each star; `best` is what fresh previews confirm."""
        self._stage("smooth", 3, self.start.smooth_basis())
        self._stage("stars", 12, None)

    def again(self, base: Design, sizes: StarUnknowns, start: StarUnknowns, steps: int = 6) -> StarUnknowns:
        """Fit each star again from sizes, and return the best ones; lengths only if the design rounds thicknesses.

        Changes count from the sizes `start`.
        """
        self.base, self.start, self._damping = base, start, FIRST_DAMPING
        self.unknowns = self.best = sizes
        if base.required_stars.rounding is not None:
            self._varies = np.arange(len(sizes.units)) < len(sizes.sizes_mm)
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
            has_small_gain = self.state.rms_mm > 0.98 * before
            if (taken % 3 == 0 or taken == count or has_small_gain) and not self._confirm():
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
        # the form is another one if the rms distance differs by more than a tenth, and by more than 0.02 mm
        if abs(fresh - followed) <= max(0.1 * followed, 0.02):
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
        self.state, self._is_fresh = self.residual.at(self._lens()), True

    def _step(self, basis: Floats | None) -> bool:
        """Take one step; False if none is accepted."""
        jacobian = self._jacobian()
        rough = self.start.roughness()
        change = self.unknowns.values - self.start.values
        count = len(change)
        # mm per unit: weight of the differences between neighbours, and of the changes themselves
        weight = 0.12**2 * rough.toarray() + 0.01**2 / count * np.eye(count)
        normal = jacobian.T @ jacobian + weight
        gradient = jacobian.T @ self.state.values + weight @ change
        scale = float(np.diag(normal).max())
        cost = self._cost(self.state, self.unknowns, weight)
        low, high = self._bounds()
        before, state_before, unknowns_before = self.preview.snapshot(), self.state, self.unknowns
        while self._damping <= 1e3:
            damped = normal + self._damping * scale * np.eye(count)
            if basis is None:
                step = _bounded_step(damped, gradient, low, high)
            else:
                step = basis @ np.linalg.solve(basis.T @ damped @ basis, -basis.T @ gradient)
                step = np.clip(step, low, high)
            predicted = -(gradient @ step + 0.5 * step @ normal @ step)
            if predicted > 0.0 and self._try(step, cost, predicted, weight):
                self._damping = max(0.3 * self._damping, 1e-9)
                return True
            self.preview.restore(before)
            self.state, self.unknowns = state_before, unknowns_before
            self._damping *= 8.0
        self._damping = FIRST_DAMPING
        return False

    def _bounds(self) -> tuple[Floats, Floats]:
        low, high = self.unknowns.bounds
        # largest change of an unknown in one step
        low, high = np.maximum(low, -2.5), np.minimum(high, 2.5)
        return np.where(self._varies, low, 0.0), np.where(self._varies, high, 0.0)

    def _cost(self, state: SheetState, unknowns: StarUnknowns, weight: Floats) -> float:
        change = unknowns.values - self.start.values
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
        state = self.residual.at(self._lens())
        linear = self.residual.at(self._lens(stages[0].x)).places
        miss = _rms(state.places - linear)
        # distance from the linear prediction: at most this part of the step; 0.1 mm always pass
        if miss > max(0.8 * _rms(linear - places_before), 0.1):
            return False
        # share of the predicted decrease that a step must reach
        if cost - self._cost(state, moved, weight) < 0.1 * predicted:
            return False
        self.state, self.unknowns, self._is_fresh = state, moved, False
        return True

    def _jacobian(self) -> Floats:
        """(3 n, 2 S) derivatives of the residuals by the unknowns."""
        count, columns, places = len(self.unknowns.sizes_mm), [], self.residual.places
        for number, name in enumerate(("length_mm", "thickness_mm")):
            if self._varies[number * count]:
                responses = star_sensitivity(self.preview.state, name)  # type: ignore[arg-type]
                moves = moves_at(self.preview, places.points[: places.count], responses)
                columns.append(self.residual.derivatives(self.state, moves))
            else:
                columns.append(np.zeros((len(self.state.values), count)))
        return np.hstack(columns) * self.unknowns.units


def moves_at(preview: Preview, points: Floats, responses: Floats) -> Floats:
    """(n, 3, P) moves of printed points (n, 2) for responses (N, 3, P) of the degrees of freedom of a preview."""
    located = preview.sheet.space.locate(points)
    return np.asarray(located.jets(responses.reshape(len(responses), -1))[:, 0].reshape(len(points), 3, -1))


def _rms(moves: Floats) -> float:
    return float(np.sqrt((moves**2).sum(axis=1).mean()))


def _bounded_step(normal: Floats, gradient: Floats, low: Floats, high: Floats) -> Floats:
    """(P,) the step s that minimises `s N s / 2 + g s` within `low <= s <= high`; N is positive definite."""
    step, varies = np.zeros(len(gradient)), low < high
    root = np.linalg.cholesky(normal[np.ix_(varies, varies)])
    right = solve_triangular(root, -gradient[varies], lower=True)
    step[varies] = lsq_linear(root.T, right, (low[varies], high[varies]), method="bvls").x
    return step


# 1: largest change of an unknown in the first correction; in later ones at most twice the change that was kept
FIRST_CHANGE = 1.0


@dataclass(eq=False)
class ExactCorrection:
    """Corrects the sizes of a search after its fit by the preview.

    Attributes
    ----------
    distance_of : the distance of a shape to the target.
    sizes, exact, distance : of the nearest exact shape: its sizes, itself, and its distance to the target; None before
        the first one.
    done : all exact shapes in their order, as the `corrections` of a `FitRecord`.
    """

    search: FitSearch
    distance_of: Callable[[Shape], FitDistance]
    report: Report | None = None
    sizes: StarUnknowns | None = None
    exact: Shape | None = None
    distance: FitDistance | None = None
    done: list[dict[str, Any]] = field(default_factory=list)
    _previewed: Floats = field(default_factory=lambda: np.empty((0, 3)))  # places of the preview of its sizes

    def run(self, base: Design, rounds: int, shape: Shape | None = None) -> None:
        """Correct the sizes on a design without sizes, in so many rounds at most.

        If the design rounds thicknesses, only the lengths change, and they first make up for the rounding. The start is
        `shape`, the exact one of the present sizes; by default the last one is followed, and the first one starts from
        the preview, whose form the fit is of.
        """
        search, start = self.search, self.sizes or self.search.best
        self.distance = None
        if shape is not None:
            self._keep(start, base, shape, 0.0)
        elif self.exact is None:
            self._try(start, base, 0.0)
        else:
            sizes = search.again(base, start, start)
            self._try(sizes, base, sizes.length_change(start))
        most = FIRST_CHANGE
        for _ in range(rounds):
            # % of the diameter, exact distance within which corrections end
            if self.distance is None or self.distance.weighted_percent <= 0.1:
                break
            before = self.sizes or start
            step = search.again(base, before, start).values - before.values
            promised = 100.0 * search.best_rms / search.diameter_mm
            change = float(np.abs(step).max())
            # relative decrease of the distance that a correction must promise, and the smallest change
            if promised > 0.97 * self.distance.weighted_percent or change < 0.01:
                break
            for part in (1.0, 0.4):
                share = min(1.0, part * most / change)
                sizes = before.moved(share * step)
                if self._try(sizes, base, sizes.length_change(before), share):
                    break
            else:
                break
            most = (2.0 if part == 1.0 else 1.0) * share * change

    def _try(self, sizes: StarUnknowns, base: Design, step_mm: float, share: float = 1.0) -> bool:
        """Compute the exact shape of sizes, at a share of the step that the preview has taken; whether it is kept."""
        near, design = self.exact, sizes.design(base)
        if near is not None:
            edge = near.summary["edge_mm"]
            if near.held:  # it moves as the preview does, and is then nearer to its next minimum than to others
                moves = self.search.preview.at(near.printed).bumpy - self._previewed
                near = replace(near, positions=near.positions + share * moves)
            exact = exact_shape(design, near=near, report=self.report, edge_mm=edge)
        else:
            exact = exact_shape(design, near=self.search.preview.shape(), report=self.report)
            if not exact.summary["is_minimum"]:
                exact = exact_shape(design, report=self.report)
        return self._keep(sizes, base, exact, step_mm)

    def _keep(self, sizes: StarUnknowns, base: Design, exact: Shape, step_mm: float) -> bool:
        """Keep sizes with their exact shape if it is a minimum and nearer to the target; the fit then aims by it."""
        distance = self.distance_of(exact)
        percent = distance.weighted_percent
        kept = bool(exact.summary["is_minimum"]) and (self.distance is None or percent < self.distance.weighted_percent)
        self.done.append({"mean_percent": percent, "step_mm": step_mm, "kept": kept})
        self.search.say(f"exact shape {len(self.done)}: {percent:.2f} % of the diameter, {'' if kept else 'not '}kept")
        if kept:
            self.sizes, self.exact, self.distance = sizes, exact, distance
            self.search.aim(base, sizes, exact)
            self._previewed = self.search.preview.at(exact.printed).bumpy
        return kept
