"""The fit: bounded Levenberg-Marquardt steps on the star sizes through the preview, then exact corrections.

The preview follows each step from its last equilibrium. A step counts only if the new equilibrium is a minimum, lies
near its linear prediction, and is nearer to the target. Every third step a fresh preview starts from initial guesses:
where it takes another form, the fit goes on from that form. Only what a fresh preview confirms is returned.

The exact shape of fitted sizes misses the target by the error of the preview. Corrections are steps of the same kind
with the derivatives of the exact shape (Gauss and Newton), within bounds that grow and shrink with success. A step
counts only if the new exact shape, which follows from the last one, is a certified minimum and nearer to the target.
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
from asterism.exact.star_sensitivity import SaddleError, StarResponse
from asterism.fitting.first_guess import FITTED_SIZE_DECIMALS
from asterism.fitting.reach import StarMenu
from asterism.fitting.residual import OFF_SHEET_MM, FitDistance, Residual, SheetState
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.point_location import locate
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.painted_stars import size_rows, with_painted_stars
from asterism.previews.session import Preview
from asterism.previews.solve import EDIT_START
from asterism.previews.star_sensitivity import star_sensitivity
from asterism.process.progress import Say, ignore_line
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
        lengths, thicknesses = self.sizes_mm.round(FITTED_SIZE_DECIMALS).T
        sizes = size_rows({"length_mm": lengths, "thickness_mm": thicknesses})
        return with_painted_stars(base, self.plan.sites, sizes)

    def roughness(self) -> sp.csr_array:
        """(2 S, 2 S) matrix R with `z R z` the mean square difference of the unknowns z of neighbouring stars."""
        pairs, count = self.plan.sample_pairs, len(self.sizes_mm)
        rows, signs = np.repeat(np.arange(len(pairs)), 2), np.tile([1.0, -1.0], len(pairs))
        ends = sp.coo_array((signs, (rows, pairs.ravel())), shape=(len(pairs), count)).tocsr()
        of_one_size = ends.T @ ends / max(len(pairs), 1)
        return sp.csr_array(sp.block_diag([of_one_size, of_one_size]))

    def weight(self) -> Floats:
        """(2 S, 2 S) mm^2 for changes of the unknowns: of the differences between neighbours, and of each."""
        count = len(self.values)
        return np.asarray(0.12**2 * self.roughness().toarray() + 0.01**2 / count * np.eye(count))

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

    def again(self, base: Design) -> None:
        """Fit each star again on a design, from the best sizes; lengths only if the design rounds thicknesses."""
        self.base, self.start, self._damping = base, self.best, FIRST_DAMPING
        self.unknowns = self.best
        if base.required_stars.rounding is not None:
            self._varies = np.arange(len(self.best.values)) < len(self.best.sizes_mm)
        self._renew()
        self.best_rms = self.state.rms_mm
        self._record("fresh")
        self._stage("stars", 4, None)

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
        weight = self.start.weight()
        normal, gradient = _normal_equations(self._jacobian(), self.state.values, self.start, self.unknowns, weight)
        count = len(gradient)
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
            predicted = -float(gradient @ step + 0.5 * step @ normal @ step)
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


def _normal_equations(
    jacobian: Floats, values: Floats, start: StarUnknowns, unknowns: StarUnknowns, weight: Floats
) -> tuple[Floats, Floats]:
    """Matrix (P, P) and gradient (P,) of half the square of residuals and of weighted changes from a start."""
    return jacobian.T @ jacobian + weight, jacobian.T @ values + weight @ (unknowns.values - start.values)


# 1: largest change of an unknown in the first correction; it doubles with a correction that is kept
FIRST_CHANGE = 1.0
# of this change, if the new exact shape is not nearer to the target
SMALLER_PARTS = (0.4, 0.1)


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

    def run(self, base: Design, rounds: int, shape: Shape | None = None) -> None:
        """Correct the sizes on a design without sizes, in so many rounds at most.

        If the design rounds thicknesses, only the lengths change, and they first make up for the rounding. The start is
        `shape`, the exact one of the present sizes; by default the last one is followed, and the first one starts from
        the preview, whose form the fit is of.
        """
        start, rounding = self.sizes or self.search.best, base.required_stars.rounding
        varies = np.arange(len(start.values)) < len(start.sizes_mm) if rounding else np.full(len(start.values), True)
        last = self.exact
        self.exact = self.distance = None
        if shape is not None:
            self._keep(start, start, shape)
        elif last is None:
            self._try(start, start, base, self.search.preview.shape())
        else:
            rounded = np.zeros(len(start.values))
            if rounding is not None:
                thickness = start.sizes_mm[:, 1]
                rounded[len(thickness) :] = np.log(rounding.thickness(thickness) / thickness) / THICKNESS_UNIT
            try:
                linear = _Linear(last, self.search.residual, start, start)
                step = linear.step(FIRST_CHANGE, varies, rounded)
                self._try(start.moved(step - rounded), start, base, linear.shape_after(step))
            except SaddleError:
                self._try(start, start, base, last)
        most = FIRST_CHANGE
        for _ in range(rounds):
            # % of the diameter, exact distance within which corrections end
            if self.exact is None or self.distance is None or self.distance.weighted_percent <= 0.1:
                break
            before, exact = self.sizes or start, self.exact
            try:
                linear = _Linear(exact, self.search.residual, before, start)
            except SaddleError:
                break
            for part in (1.0, *SMALLER_PARTS):
                step = linear.step(part * most, varies)
                # smallest change, and relative decrease of the distance that a correction must promise
                if np.abs(step).max() < 0.01 or linear.rms_after(step) > 0.97 * linear.rms_after(0.0 * step):
                    return
                if self._try(before.moved(step), before, base, linear.shape_after(step)):
                    break
            else:
                break
            most *= 2.0 if part == 1.0 else part

    def _try(self, sizes: StarUnknowns, before: StarUnknowns, base: Design, near: Shape) -> bool:
        """Compute the exact shape of sizes from a shape near it; whether it is kept."""
        design, edge = sizes.design(base), near.summary.get("edge_mm")
        exact = exact_shape(design, near=near, report=self.report, edge_mm=edge)
        if self.exact is None and not exact.summary["is_minimum"]:
            exact = exact_shape(design, report=self.report)
        return self._keep(sizes, before, exact)

    def _keep(self, sizes: StarUnknowns, before: StarUnknowns, exact: Shape) -> bool:
        """Keep sizes with their exact shape if it is a minimum and nearer to the target."""
        distance = self.distance_of(exact)
        percent = distance.weighted_percent
        kept = bool(exact.summary["is_minimum"]) and (self.distance is None or percent < self.distance.weighted_percent)
        self.done.append({"mean_percent": percent, "step_mm": sizes.length_change(before), "kept": kept})
        self.search.say(f"exact shape {len(self.done)}: {percent:.2f} % of the diameter, {'' if kept else 'not '}kept")
        if kept:
            self.sizes, self.exact, self.distance = sizes, exact, distance
        return kept


# unknowns whose moves are in memory at a time
UNKNOWNS_PER_BLOCK = 64


class _Linear:
    """An exact shape to first order in the P unknowns; changes of its sizes count from a start."""

    def __init__(self, exact: Shape, residual: Residual, sizes: StarUnknowns, start: StarUnknowns) -> None:
        self._exact, self._sizes = exact, sizes
        self._response = StarResponse(exact, "length_mm", "thickness_mm")
        state, places = residual.of_exact(exact), residual.places.points
        triangle, weights = locate(exact.printed, exact.triangles, places, OFF_SHEET_MM)
        columns, units = [], np.diag(sizes.units)
        for first in range(0, len(units), UNKNOWNS_PER_BLOCK):
            moves = self._response(units[:, first : first + UNKNOWNS_PER_BLOCK])
            moves = np.einsum("nk,nkcp->ncp", weights, moves[exact.triangles[triangle]])
            columns.append(residual.exact_derivatives(state, moves))
        self._values, self._jacobian = state.values, np.hstack(columns)
        self._normal, self._gradient = _normal_equations(self._jacobian, state.values, start, sizes, start.weight())

    def step(self, most: float, varies: np.ndarray, known: Floats | float = 0.0) -> Floats:
        """(P,) the best change by at most so much of the unknowns that vary, beside a known change of the others."""
        low, high = (np.where(varies, np.clip(bound, -most, most), 0.0) for bound in self._sizes.bounds)
        known = np.broadcast_to(known, low.shape)
        return known + _bounded_step(self._normal, self._gradient + self._normal @ known, low, high)

    def rms_after(self, step: Floats) -> float:
        """mm, root mean square distance to the target after a change (P,)."""
        return float(np.linalg.norm((self._values + self._jacobian @ step)[::3]))

    def shape_after(self, step: Floats) -> Shape:
        """The shape after a change (P,)."""
        moves = self._response((self._sizes.units * step)[:, None])[..., 0]
        return replace(self._exact, positions=self._exact.positions + moves)
