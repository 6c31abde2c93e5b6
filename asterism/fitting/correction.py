"""Corrections of a fit by the exact model.

The exact shape of a design misses the target by the error of the preview. This error changes little from one design to
the next, so that it is added to the preview and the sizes are fitted again. A correction counts only if the exact shape
of the corrected sizes is a certified minimum and nearer to the target. If it is not, half of the error is added.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from asterism.exact.simulation import exact_shape
from asterism.fitting.distance import FitDistance, target_distance
from asterism.fitting.residual import FitPlaces
from asterism.fitting.search import FitSearch
from asterism.fitting.star_unknowns import StarUnknowns
from asterism.fitting.target import TargetSurface
from asterism.previews.run import preview
from asterism.previews.session import Preview
from asterism.shape.shape import Shape
from discrete.release.continuation import Report
from equilibrium.arrays import Floats
from pattern.design.design import Design
from pattern.geometry.rigid_fit import rigid_fit

# steps of the fit for one correction
CORRECTION_STEPS = 4
# % of the diameter, exact distance within which corrections end
EXACT_GOAL_PERCENT = 0.2
# factor of the added error after a correction that does not count, and the smallest share that is tried
SHARE_AFTER_FAILURE, MIN_SHARE = 0.5, 0.25
# mm, places of the print this far off the triangles of the exact model are taken to them
OFF_SHEET_MM = 0.25


@dataclass(frozen=True)
class Correction:
    """One exact shape on the way.

    Attributes
    ----------
    mean_percent : its distance to the target, by the weights of the places, in % of the diameter.
    share : of the preview's error that was added to find its sizes; 0 for the fit by the preview alone.
    kept : whether it is nearer than those before.
    """

    mean_percent: float
    share: float
    kept: bool


@dataclass(eq=False)
class ExactCorrection:
    """Corrects the sizes of a search; the arguments are those of the fit.

    Attributes
    ----------
    done : all exact shapes, in their order.
    offset_mm : (n, 3), cell mean of exact shape minus preview at the residual's places, of the best sizes.
    exact, distance : the exact shape of the best sizes, and its distance to the target; None before the first one.
    """

    search: FitSearch
    target: TargetSurface
    places: FitPlaces
    lattice_vectors: Floats
    report: Report | None = None
    done: list[Correction] = field(default_factory=list)
    offset_mm: Floats | None = None
    exact: Shape | None = None
    distance: FitDistance | None = None

    def run(self, base: Design, rounds: int, lengths_only: bool = False) -> None:
        """Correct the best sizes of the search, on a design; they are those of the nearest exact shape afterwards.

        Parameters
        ----------
        base : design without its sizes.
        rounds : largest number of corrections.
        lengths_only : keep the thicknesses.
        """
        search, near = self.search, self.exact
        self.exact = self.distance = None
        self._measure(search.best, base, near, 0.0)
        best, share = search.best, 1.0
        for _ in range(rounds):
            distance = self.distance
            if distance is None or self.offset_mm is None or distance.weighted_percent <= EXACT_GOAL_PERCENT:
                break
            search.refine(base, CORRECTION_STEPS, share * self.offset_mm, lengths_only)
            if search.best is not best and self._measure(search.best, base, self.exact, share):
                best = search.best
                continue
            search.best = best
            share *= SHARE_AFTER_FAILURE
            if share < MIN_SHARE:
                break
        search.best = best

    def _measure(self, unknowns: StarUnknowns, base: Design, near: Shape | None, share: float) -> bool:
        """Compute the exact shape of sizes; whether it is nearer to the target than those before."""
        design, law = unknowns.design(base), self.search.law
        exact = exact_shape(design, near=near or preview(design, law), report=self.report)
        distance = target_distance(exact, self.target, self.places, self.lattice_vectors)
        before = np.inf if self.distance is None else self.distance.weighted_percent
        kept = bool(exact.summary["is_minimum"]) and distance.weighted_percent < before
        self.done.append(Correction(distance.weighted_percent, share, kept))
        verdict = "kept" if kept else "not kept"
        self.search.say(f"exact shape {len(self.done)}: {distance.weighted_percent:.2f} % of the diameter, {verdict}")
        if kept:
            self.exact, self.distance = exact, distance
            self.offset_mm = self._offset(exact, Preview(design, law))
        return kept

    def _offset(self, exact: Shape, quick: Preview) -> Floats:
        shown = quick.lens(self.places.points)()
        before = shown.smooth + shown.bumps
        after = exact.at(self.places.points, OFF_SHEET_MM)
        if not exact.held:
            rotation, shift = rigid_fit(after, before)
            after = after @ rotation.T + shift
        return self.places.bump_mean(after - before)
