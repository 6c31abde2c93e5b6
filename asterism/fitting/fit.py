"""`asterism.fit`: a design whose shape comes near to a target surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from asterism.discrete.release.continuation import Report
from asterism.fitting.correction import ExactCorrection
from asterism.fitting.defaults import MAX_ASKED_CORRECTIONS, MAX_CORRECTIONS, MAX_FITTED_NEEDLES, REACHED_PERCENT
from asterism.fitting.distance import FitDistance, target_distance
from asterism.fitting.errors import place_text
from asterism.fitting.first_guess import FirstGuess, guess_design
from asterism.fitting.place_weight import weighted_target, with_weights
from asterism.fitting.residual import FitPlaces, Residual
from asterism.fitting.search import FitSearch
from asterism.fitting.star_unknowns import StarUnknowns
from asterism.fitting.target import TargetSurface
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.section import is_whole
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import paper_law
from asterism.previews.run import preview
from asterism.print.printer import Printer
from asterism.print.rounded import choose_rounding, with_rounding
from asterism.process.listeners import Say, ignore_line
from asterism.process.version import __version__
from asterism.results.records.fit import FitRecord, TargetDistanceRecord
from asterism.shape.shape import Shape
from asterism.verification.numbers import MAX_FORM_DISTANCE_PERCENT
from asterism.verification.run import verify
from asterism.verification.verification import RELEASE, Verification


@dataclass(frozen=True, eq=False)
class Fit:
    """A design for a target, with the evidence of how near its shape comes.

    Attributes
    ----------
    design : as it is written and was verified.
    target : in the pose of the fit.
    guess : the first guess, with the map to the print and what stars can do.
    preview : fresh preview of the design.
    verification : preview and exact shapes; None if the exact model was not asked for.
    distance : of the exact shape to the target, or of the preview without one.
    summary : the numbers of summary.json.
    """

    design: Design
    target: TargetSurface
    guess: FirstGuess
    preview: Shape
    verification: Verification | None
    distance: FitDistance
    summary: FitRecord

    @property
    def shape(self) -> Shape:
        """The exact shape, or the preview without one; a free sheet is laid on the target."""
        return self.distance.shape


# steps on the lengths after thicknesses are rounded
ROUNDED_STEPS = 4
# corrections by the exact model: largest number for the lengths after rounding
MAX_ROUNDED_CORRECTIONS = 3
# a warning names the share of stars at the ends of the law's lengths from this one on
MIN_SHARE_AT_BOUNDS = 0.1
# % of the diameter, largest distance from which on a warning names its place
MAX_QUIET_DISTANCE_PERCENT = 4.0


def fit(
    target: TargetSurface,
    law: StarLaw | None = None,
    stretch: float | None = None,
    needles: int | None = None,
    printer: Printer | None = None,
    exact: bool = True,
    nearest: bool = False,
    within_percent: float = REACHED_PERCENT,
    say: Say | None = None,
    report: Report | None = None,
    border: bool | None = None,
    corrections: int = MAX_CORRECTIONS,
    weight: str | Path | ArrayLike | None = None,
    width_mm: float | None = None,
) -> Fit:
    """Find star sizes whose sheet comes near to a target surface.

    The target is flattened conformally, which gives the contraction that each place needs; the law gives the stars.
    Then star lengths and thicknesses are fitted through the preview. The exact model corrects them and checks the
    result.

    Parameters
    ----------
    target : from `load_target`, or made by `TargetSurface.of_formula`, `of_heights` or `of_triangles`.
    law : of the material, whose lattice the design has; that of the paper's material by default.
    stretch : of the fabric; by default the smallest one of the law whose stars contract differently enough.
    needles : number of needles that hold the outline at their places on the target; 0 for a free sheet. By default they
        stand at the corners of the target, and at distances of about 1.6 spacings between, or `border` applies.
    printer : whose layers and lines the thicknesses and widths are rounded to; not rounded by default.
    exact : correct the sizes by the exact model, and check the design as `verify` does.
    nearest : if stars cannot contract as differently or curve as tightly as the target needs, make the sheet that comes
        nearest, in place of an error.
    within_percent : distance, in % of the diameter, within which the target counts as reached.
    say, report : as in `simulate`.
    border : hold the whole border along that of the target, in place of needles. By default if needles are not given
        and a quarter of the absolute Gauss curvature of the target is negative.
    corrections : largest number of corrections by the exact model; 0 leaves the fit by the preview as it is.
    weight : of the places: where it is larger, the fit comes nearer. A formula in x, y, z, r and theta (mm in the
        target's file), a grey picture as one sees the target along z (black 1, white 10), or (V,) numbers at the
        vertices of `target.disk`; from 0.01 to 100. The design keeps the weights in its section `[fit]`, and
        `within_percent` counts all places alike.
    width_mm : of all arms; 1.2 mm by default. The fit changes lengths and thicknesses.

    Returns
    -------
    The design, its shapes and their distance to the target.

    Raises
    ------
    TargetError, ReachError
        The target has no flattening, or stars cannot make it.
    LawError
        The law has no table for the stretch, or does not cover the width.
    ValueError
        `needles` is not a whole number from 0 to 1000, or is 1 or 2, or is given with `border`; or `corrections` is not
        a whole number from 0 to 20.

    Examples
    --------
    >>> target = TargetSurface.of_formula("10*(1 - (x/50)**2 - (y/50)**2)", 80.0, name="dome")
    >>> fitted = fit(target, exact=False)
    >>> fitted.summary.preview.mean_percent < 0.5, fitted.summary.reached
    (True, True)
    """
    check_type(target, TargetSurface, "load_target reads one from a file")
    if needles is not None and not (is_whole(needles) and 0 <= needles <= MAX_FITTED_NEEDLES and needles not in (1, 2)):
        raise ValueError(f"needles = {needles!r}: must be 0, or a whole number from 3 to {MAX_FITTED_NEEDLES}")
    if needles is not None and border:
        raise ValueError(f"needles = {needles}: must be None with border=True")
    if not (is_whole(corrections) and 0 <= corrections <= MAX_ASKED_CORRECTIONS):
        raise ValueError(f"corrections = {corrections!r}: must be a whole number from 0 to {MAX_ASKED_CORRECTIONS}")
    if law is not None:
        check_type(law, StarLaw, "load_law reads one from a file")
    law, tell = law or paper_law(), say or ignore_line
    if weight is not None:
        target = weighted_target(target, weight)
    guess = guess_design(target, law, stretch, needles, nearest, tell, border, width_mm)
    plan = layout(guess.design)
    guess = replace(guess, design=with_weights(guess.design, target, guess.target_map, plan))
    places = FitPlaces.of(guess.target_map, plan.outline, plan.lattice_vectors)
    is_free = not plan.pins

    def distance(shape: Shape) -> FitDistance:
        return target_distance(shape, target, places, plan.lattice_vectors)

    def measured() -> TargetDistanceRecord:
        shape = search.preview.shape()
        return _record(distance(shape), shape)

    search = FitSearch(
        guess.design,
        law,
        Residual(target, places, is_free),
        target.diameter_mm,
        StarUnknowns.of(plan, guess.menu),
        tell,
    )
    of_guess = measured()
    search.run()
    by_preview = None if printer is None else measured()
    of_exact, corrected = ExactCorrection(search, target, plan.lattice_vectors, report), exact and corrections > 0
    if corrected:
        of_exact.run(guess.design, corrections)
    unrounded, base = of_exact.distance, guess.design
    rounded_corrections = min(corrections, MAX_ROUNDED_CORRECTIONS)
    if printer is not None:
        rounding = choose_rounding(layout(search.best.design(base)), printer)
        tell(f"rounding to layers of {rounding.layer_mm:g} mm on {rounding.first_layer_mm:g} mm")
        base = with_rounding(base, rounding)
        if corrected:
            of_exact.run(base, rounded_corrections)
        else:
            search.refine_lengths(base, ROUNDED_STEPS)

    def verified() -> Verification:
        design = search.best.design(base)
        return verify(design, law, report=report, say=tell, ready=preview(design, law), near=of_exact.exact)

    verification = verified() if exact else None
    if corrected and verification is not None and _released_elsewhere(verification):
        # the print comes to another minimum than the corrections followed: they begin again from that one
        before, sizes = distance(verification.exact[RELEASE]), search.best
        of_exact.run(base, rounded_corrections, verification.exact[RELEASE])
        again = verified()
        if distance(again.exact[again.result]).weighted_percent < before.weighted_percent:
            verification = again
        else:
            search.best = sizes
    design = search.best.design(base)
    shape = verification.preview if verification is not None else search.preview.shape()
    result = shape if verification is None else verification.exact[verification.result]
    of_preview = distance(shape)
    of_result = of_preview if verification is None else distance(result)
    record = _record(of_preview, shape)
    loss = None if by_preview is None else of_preview.mean_percent - by_preview.mean_percent
    if loss is not None and unrounded is not None:
        loss = of_result.mean_percent - unrounded.mean_percent
    summary: dict[str, Any] = {
        "model": "fit",
        "target": target.name,
        "diameter_mm": target.diameter_mm,
        "motion": target.motion.tolist(),
        "shift_mm": target.shift_mm.tolist(),
        "stretch": guess.menu.stretch,
        "stars": len(plan.centres),
        "needles": sum(len(pins.corners or ()) for pins in design.pins),
        "held_border": any(pins.where == "border" for pins in design.pins),
        **{name: value for name, value in vars(guess.reach).items() if name != "warnings"},
        "share_at_bounds": search.best.share_at_bounds,
        "first_guess": of_guess,
        "unrounded": by_preview,
        "preview": record,
        "exact": None if verification is None else _record(of_result, result),
        "other_exact": _other(verification, distance),
        "exact_agrees": None if verification is None else verification.summary.starts_agree,
        "reached": bool(of_result.mean_percent <= within_percent and result.summary["is_minimum"]),
        "within_percent": within_percent,
        "rounding_loss_percent": loss,
        "steps": [vars(step) for step in search.steps],
        "corrections": [vars(step) for step in of_exact.done],
        "restarts": search.restarts,
        "warnings": [*guess.reach.warnings, *_warnings(search, of_result, verification)],
        "version": __version__,
        "design": design.to_dict(),
    }
    return Fit(design, target, guess, shape, verification, of_result, FitRecord.from_json(summary))


def _released_elsewhere(verification: Verification) -> bool:
    """Whether the flat print releases to another minimum than the one near the target, of lower energy."""
    return verification.result == RELEASE and not verification.summary.starts_agree


def _record(distance: FitDistance, shape: Shape) -> TargetDistanceRecord:
    return TargetDistanceRecord(
        mean_percent=distance.mean_percent,
        weighted_percent=distance.weighted_percent,
        surface_percent=distance.surface_percent,
        largest_percent=distance.largest_percent,
        largest_at_mm=[float(part) for part in np.round(distance.farthest, 1)],
        is_minimum=bool(shape.summary["is_minimum"]),
    )


def _other(verification: Verification | None, distance: Callable[[Shape], FitDistance]) -> TargetDistanceRecord | None:
    """Distance of the exact minimum that is not the result; None if both starts lead to one."""
    if verification is None or verification.summary.starts_agree:
        return None
    other = next(shape for name, shape in verification.exact.items() if name != verification.result)
    return _record(distance(other), other)


def _warnings(search: FitSearch, distance: FitDistance, verification: Verification | None) -> list[str]:
    """What limits the fit, one line each."""
    lines = []
    share = search.best.share_at_bounds
    if share > MIN_SHARE_AT_BOUNDS:
        lines.append(f"{100 * share:.0f} % of the stars have the shortest or the longest arms that the law covers")
    if distance.largest_percent > MAX_QUIET_DISTANCE_PERCENT:
        lines.append(
            f"the largest distance, {distance.largest_percent:.1f} % of the diameter, is at "
            f"{place_text(distance.farthest, 0)}: more needles hold a rim, a larger target has more stars"
        )
    if verification is not None and verification.summary.starts_distance_percent > MAX_FORM_DISTANCE_PERCENT:
        apart = verification.summary.starts_distance_percent
        lines.append(f"two forms: a print may rest in another one, {apart:.1f} % of the diameter away")
    return lines
