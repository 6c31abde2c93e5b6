"""Corrections of a fit by the exact model: the preview aims beside the target by the difference of the two models.

The exact shape of fitted sizes misses the target by the error of the preview, and this error changes little with the
sizes. Its residuals are therefore added to those of the preview, and the fit by the preview goes on from there (defect
correction: Stetter 1978, The defect correction principle and discretization methods). What it converges to has exact
residuals. A correction takes one exact shape, which follows from the last one, and no derivatives of the exact model.
A step counts only if the new exact shape is a certified minimum and nearer to the target; otherwise a part of it is
tried.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from asterism.discrete.release.continuation import Report
from asterism.equilibrium.arrays import Floats
from asterism.exact.simulation import exact_shape
from asterism.fitting.residual import FitDistance
from asterism.fitting.search import FitSearch
from asterism.fitting.star_unknowns import StarUnknowns
from asterism.pattern.design.design import Design
from asterism.previews.session import preview
from asterism.shape.shape import Shape

# % of the diameter, exact distance within which corrections end
EXACT_GOAL_PERCENT = 0.1
# steps of the fit by the preview between two exact shapes
CORRECTION_STEPS = 6
# parts of a correction that are tried
PARTS = (1.0, 0.4)
# relative decrease of the distance that a correction must promise
MIN_PROMISED_GAIN = 0.03


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
        `shape`, the exact one of the present sizes; by default the last one is followed, and the first one is that
        which the flat print releases to.
        """
        search, start = self.search, self.sizes or self.search.best
        self.distance = None
        if shape is not None:
            self._keep(start, base, shape, 0.0)
        elif self.exact is None:
            self._try(start, base, 0.0)
        else:
            sizes = search.again(base, start, start, CORRECTION_STEPS)
            self._try(sizes, base, sizes.length_change(start))
        for _ in range(rounds):
            if self.distance is None or self.distance.weighted_percent <= EXACT_GOAL_PERCENT:
                break
            before = self.sizes or start
            step = search.again(base, before, start, CORRECTION_STEPS).difference(before)
            promised = 100.0 * search.best_rms / search.diameter_mm
            if promised > (1.0 - MIN_PROMISED_GAIN) * self.distance.weighted_percent:
                break
            parts = (before.moved(part * step) for part in PARTS)
            if not any(self._try(sizes, base, sizes.length_change(before)) for sizes in parts):
                break

    def _try(self, sizes: StarUnknowns, base: Design, step_mm: float) -> bool:
        """Compute the exact shape of sizes; whether it is kept."""
        near, design = self.exact, sizes.design(base)
        if near is not None:
            edge = near.summary["edge_mm"]
            if near.held:  # it moves as the preview does, and is then nearer to its next minimum than to others
                self.search.preview.update(design)
                moves = self.search.preview.at(near.printed).bumpy - self._previewed
                near = replace(near, positions=near.positions + moves)
            exact = exact_shape(design, near=near, report=self.report, edge_mm=edge)
        else:
            exact = exact_shape(design, report=self.report)
            if not exact.summary["is_minimum"]:
                exact = exact_shape(design, near=preview(design, self.search.law), report=self.report)
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
