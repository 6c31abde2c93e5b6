"""Corrections of a fit by the exact model: damped Gauss-Newton steps with the sensitivities of the exact shape.

The exact shape of a fitted design misses the target by the error of the preview. Its own sensitivities give the step
to the next sizes, and the exact model follows from its last shape. A step counts only if the new exact shape is a
certified minimum and nearer to the target; after a step that does not count, a shorter one is tried.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asterism.discrete.release.continuation import Report
from asterism.equilibrium.arrays import Floats
from asterism.exact.exact_sensitivity import ExactSensitivity, NoMinimumError
from asterism.exact.simulation import exact_shape
from asterism.fitting.bounded_step import bounded_step
from asterism.fitting.distance import FitDistance, target_distance
from asterism.fitting.first_guess import FITTED_SIZE_DECIMALS
from asterism.fitting.residual import SheetState
from asterism.fitting.search import CHANGE_WEIGHT, LONGEST_STEP, NEIGHBOUR_WEIGHT, FitSearch
from asterism.fitting.star_unknowns import THICKNESS_UNIT, StarUnknowns
from asterism.fitting.target import TargetSurface
from asterism.pattern.design.design import Design
from asterism.pattern.design.rounding import Rounding
from asterism.previews.run import preview
from asterism.shape.shape import Shape

# % of the diameter, exact distance within which corrections end
EXACT_GOAL_PERCENT = 0.1
# damping relative to the largest diagonal entry of the normal equations
EXACT_DAMPING = 1e-4
# factors of the largest change of an unknown after a step that counts, and after one that does not, relative to it
WIDER_AFTER_SUCCESS, NARROWER_AFTER_FAILURE = 2.0, 0.4
# relative decrease of the squared distance that a step must promise
MIN_PROMISED_GAIN = 0.05


@dataclass(frozen=True)
class Correction:
    """One exact shape on the way.

    Attributes
    ----------
    mean_percent : its distance to the target, by the weights of the places, in % of the diameter.
    step_mm : largest change of a length since the last shape that was kept; 0 for a first shape.
    kept : whether it is nearer than those before.
    """

    mean_percent: float
    step_mm: float
    kept: bool


@dataclass(eq=False)
class ExactCorrection:
    """Corrects the sizes of a search; the arguments are those of the fit.

    Attributes
    ----------
    done : all exact shapes, in their order.
    exact, distance : the exact shape of the best sizes, and its distance to the target; None before the first one.
    """

    search: FitSearch
    target: TargetSurface
    lattice_vectors: Floats
    report: Report | None = None
    done: list[Correction] = field(default_factory=list)
    exact: Shape | None = None
    distance: FitDistance | None = None

    def run(self, base: Design, rounds: int, shape: Shape | None = None) -> None:
        """Correct the best sizes of the search, on a design; they are those of the nearest exact shape afterwards.

        If the design rounds thicknesses, the lengths first make up for that to first order, and only they change.

        Parameters
        ----------
        base : design without its sizes.
        rounds : largest number of corrections.
        shape : exact shape of the best sizes to start from. By default the last one is followed, and the first one is
            that which the flat print releases to.
        """
        start = sizes = self.search.best
        near, self.distance = self.exact, None
        rounding = base.required_stars.rounding
        if shape is not None:
            self._keep(shape)
        else:
            if near is not None and rounding is not None:
                sizes = self._rounded(sizes, rounding)
            self._measure(sizes, base, near, sizes.length_change(start))
        longest, columns = LONGEST_STEP, None
        weight = _weight(start)
        for _ in range(rounds):
            if self.distance is None or self.distance.weighted_percent <= EXACT_GOAL_PERCENT:
                break
            if columns is None:
                try:
                    state, columns = self._columns(sizes.design(base), rounding is None)
                except NoMinimumError:  # a star snaps, so that the shape has no derivatives
                    self.search.say("the exact shape is too near to another one to be corrected further")
                    break
                columns *= sizes.units
            normal = columns.T @ columns + weight
            normal += EXACT_DAMPING * float(np.diag(normal).max()) * np.eye(len(normal))
            gradient = columns.T @ state.values + weight @ sizes.difference(start)
            step = bounded_step(normal, gradient, *_limits(sizes, longest, rounding is None))
            promised = -2.0 * float(gradient @ step + 0.5 * step @ normal @ step)
            if promised < MIN_PROMISED_GAIN * float(state.values @ state.values):
                break
            moved = sizes.moved(step)
            if self._measure(moved, base, self.exact, moved.length_change(sizes)):
                sizes, columns, longest = moved, None, min(WIDER_AFTER_SUCCESS * longest, LONGEST_STEP)
            else:
                longest = NARROWER_AFTER_FAILURE * float(np.abs(step).max())
        self.search.best = sizes

    def _rounded(self, sizes: StarUnknowns, rounding: Rounding) -> StarUnknowns:
        """Sizes whose lengths make up for rounded thicknesses, to first order around the last exact shape."""
        count = len(sizes.lengths_mm)
        assert self.exact is not None
        state, columns = self._columns(Design.from_dict(self.exact.summary["design"]), True)
        columns *= sizes.units
        change = np.zeros(2 * count)
        printed = rounding.thickness(sizes.thicknesses_mm.round(FITTED_SIZE_DECIMALS))
        change[count:] = np.log(printed / sizes.thicknesses_mm) / THICKNESS_UNIT
        weight = _weight(sizes)
        normal = columns.T @ columns + weight
        normal += EXACT_DAMPING * float(np.diag(normal).max()) * np.eye(len(normal))
        gradient = columns.T @ (state.values + columns @ change)
        return sizes.moved(bounded_step(normal, gradient, *_limits(sizes, LONGEST_STEP, False)))

    def _columns(self, design: Design, has_thicknesses: bool) -> tuple[SheetState, Floats]:
        """Residuals of the exact shape, and their derivatives (3 n, 2 S) by lengths and thicknesses, per mm."""
        residual = self.search.residual
        assert self.exact is not None
        state = residual.of_exact(self.exact)
        of_shape = ExactSensitivity(design, self.exact, residual.places.points)
        lengths = residual.exact_derivatives(state, of_shape.moves("length_mm"))
        if not has_thicknesses:
            return state, np.hstack([lengths, np.zeros_like(lengths)])
        return state, np.hstack([lengths, residual.exact_derivatives(state, of_shape.moves("thickness_mm"))])

    def _measure(self, sizes: StarUnknowns, base: Design, near: Shape | None, step_mm: float) -> bool:
        """Compute the exact shape of sizes; whether it is nearer to the target than those before."""
        design = sizes.design(base)
        if near is None:
            exact = exact_shape(design, report=self.report)
            if not exact.summary["is_minimum"]:
                exact = exact_shape(design, near=preview(design, self.search.law), report=self.report)
        else:
            exact = exact_shape(design, near=near, report=self.report, edge_mm=near.summary["edge_mm"])
        distance = self._distance_of(exact)
        before = np.inf if self.distance is None else self.distance.weighted_percent
        kept = bool(exact.summary["is_minimum"]) and distance.weighted_percent < before
        self.done.append(Correction(distance.weighted_percent, step_mm, kept))
        verdict = "kept" if kept else "not kept"
        self.search.say(f"exact shape {len(self.done)}: {distance.weighted_percent:.2f} % of the diameter, {verdict}")
        if kept:
            self.exact, self.distance = exact, distance
        return kept

    def _keep(self, shape: Shape) -> None:
        self.exact, self.distance = shape, self._distance_of(shape)
        self.done.append(Correction(self.distance.weighted_percent, 0.0, True))
        self.search.say(
            f"exact shape {len(self.done)}: {self.distance.weighted_percent:.2f} % of the diameter, released"
        )

    def _distance_of(self, shape: Shape) -> FitDistance:
        return target_distance(shape, self.target, self.search.residual.places, self.lattice_vectors)


def _weight(sizes: StarUnknowns) -> Floats:
    """(2 S, 2 S) of the changes from the start: of their differences between neighbours, and of the changes."""
    count = len(sizes.units)
    return np.asarray(NEIGHBOUR_WEIGHT**2 * sizes.roughness().toarray() + CHANGE_WEIGHT**2 / count * np.eye(count))


def _limits(sizes: StarUnknowns, longest: float, has_thicknesses: bool) -> tuple[Floats, Floats]:
    """(2 S,) smallest and largest step."""
    low, high = sizes.bounds
    varies = np.arange(len(low)) < (len(low) if has_thicknesses else len(sizes.lengths_mm))
    return np.where(varies, np.maximum(low, -longest), 0.0), np.where(varies, np.minimum(high, longest), 0.0)
