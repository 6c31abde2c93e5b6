"""`asterism.fit`: a design whose shape comes near to a target surface, and the evidence of how near it comes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from asterism.discrete.release.continuation import Report
from asterism.fitting.disk import place_text
from asterism.fitting.first_guess import FirstGuess, guess_design
from asterism.fitting.residual import FitDistance, FitPlaces, Residual, target_distance
from asterism.fitting.search import ExactCorrection, FitSearch, StarUnknowns
from asterism.fitting.target import TargetSurface
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import check_type
from asterism.pattern.layout.build import layout
from asterism.previews.law_choice import paper_law
from asterism.previews.session import preview
from asterism.print.printer import Printer
from asterism.print.rounding import choose_rounding, with_rounding
from asterism.process.progress import Say, ignore_line
from asterism.process.settings import FitSettings
from asterism.process.version import __version__
from asterism.results.records.fit import FitRecord, TargetDistanceRecord
from asterism.shape.shape import Shape
from asterism.verification.verify import MAX_FORM_DISTANCE_PERCENT, RELEASE, Verification, verify


@dataclass(frozen=True, eq=False)
class Fit:
    """A design for a target, with the evidence of how near its shape comes.

    Attributes
    ----------
    design : as it is written and was verified.
    target : in the pose of the fit.
    guess : the first guess, with the map to the print and what stars can do.
    preview : fresh preview of the design.
    verification : preview and exact shapes; None if the exact model was not asked for, or the fit was interrupted.
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


class FitInterrupted(KeyboardInterrupt):
    """Ctrl-C has ended a fit.

    Attributes
    ----------
    fitted : the best design until then, by the preview.
    """

    def __init__(self, fitted: Fit) -> None:
        super().__init__("the fit was interrupted")
        self.fitted = fitted


def fit(
    target: TargetSurface,
    settings: FitSettings | None = None,
    law: StarLaw | None = None,
    printer: Printer | None = None,
    say: Say | None = None,
    report: Report | None = None,
) -> Fit:
    """Find star sizes whose sheet comes near to a target surface.

    The target is flattened conformally, which gives the contraction that each place needs; the law gives the stars.
    Then star lengths and thicknesses are fitted through the preview. The exact model corrects them and checks the
    result.

    Parameters
    ----------
    target : from `load_target`, or made by `TargetSurface.of_formula`, `of_heights` or `of_triangles`. Where its weight
        is larger, the fit comes nearer; the design keeps the weights in its section `[fit]`.
    law : of the material, whose lattice the design has; that of the paper's material by default.
    printer : whose layers and lines the thicknesses and widths are rounded to; not rounded by default.
    say, report : as in `simulate`.

    Returns
    -------
    The design, its shapes and their distance to the target.

    Raises
    ------
    TargetError, ReachError
        The target has no flattening, or stars cannot make it.
    LawError
        The law has no table for the stretch, or does not cover the width.
    FitInterrupted
        A `KeyboardInterrupt` after the first guess; it holds the best design until then.

    Examples
    --------
    >>> target = TargetSurface.of_formula("10*(1 - (x/50)**2 - (y/50)**2)", 80.0, name="dome")
    >>> fitted = fit(target, FitSettings(exact=False))
    >>> fitted.summary.preview.mean_percent < 0.5, fitted.summary.reached
    (True, True)
    """
    check_type(target, TargetSurface, "load_target reads one from a file")
    settings = FitSettings() if settings is None else settings
    check_type(settings, FitSettings, "FitSettings(exact=False) is an example")
    if law is not None:
        check_type(law, StarLaw, "load_law reads one from a file")
    law, tell = law or paper_law(), say or ignore_line
    guess = guess_design(target, law, settings, tell)
    base, plan = guess.design, layout(guess.design)
    places = FitPlaces.of(guess.target_map, plan.outline, plan.lattice_vectors)
    residual = Residual(target, places, not plan.pins)

    def distance(shape: Shape) -> FitDistance:
        return target_distance(shape, residual, plan.lattice_vectors)

    def sizes() -> StarUnknowns:
        return correction.sizes or search.best

    def verified() -> Verification:
        design, near = sizes().design(base), correction.exact if correction.distance else None
        return verify(design, law, report=report, say=tell, ready=preview(design, law), near=near)

    search = FitSearch(base, law, residual, target.diameter_mm, StarUnknowns.of(plan, guess.menu), tell)
    correction = ExactCorrection(search, distance, report)
    of_guess, by_preview, unrounded = distance(search.preview.shape()).record, None, None
    verification: Verification | None = None
    corrections = settings.corrections if settings.exact else 0
    few = min(corrections, 3)  # after thicknesses are rounded
    is_interrupted = False
    try:
        search.run()
        by_preview = None if printer is None else distance(search.preview.shape()).record
        if corrections:
            correction.run(base, corrections)
        unrounded = correction.distance
        if printer is not None:
            base = _rounded(base, sizes(), printer, tell)
            if corrections:
                correction.run(base, few)
            else:
                search.again(base)
        if settings.exact:
            verification = verified()
        if corrections and verification and verification.result == RELEASE and not verification.summary.starts_agree:
            # the flat print releases to another minimum, of lower energy, than the corrections followed: they begin
            # again from that one
            before, first = distance(verification.exact[RELEASE]), correction.sizes
            correction.run(base, few, verification.exact[RELEASE])
            again = verified()
            if distance(again.exact[again.result]).weighted_percent < before.weighted_percent:
                verification = again
            else:
                correction.sizes = first
    except KeyboardInterrupt:
        is_interrupted, verification = True, None
        if printer is not None and base is guess.design:
            base = _rounded(base, sizes(), printer, tell)
    found = sizes()
    design = found.design(base)
    if verification is not None:
        shape, result = verification.preview, verification.exact[verification.result]
    else:
        shape = result = preview(design, law) if is_interrupted or corrections else search.preview.shape()
    of_preview = of_result = distance(shape)
    if result is not shape:
        of_result = distance(result)
    loss = None if by_preview is None else of_preview.mean_percent - by_preview.mean_percent
    if unrounded is not None and verification is not None:
        loss = of_result.mean_percent - unrounded.mean_percent
    warnings = [*guess.reach.warnings, *_warnings(found, of_result, verification)]
    if is_interrupted:
        warnings.insert(0, "interrupted: the design is the best one until then, and the exact model has not checked it")
    summary = FitRecord(
        model="fit",
        target=target.name,
        diameter_mm=target.diameter_mm,
        motion=target.motion.tolist(),
        shift_mm=target.shift_mm.tolist(),
        stretch=guess.menu.stretch,
        stars=len(plan.centres),
        needles=sum(len(pins.corners or ()) for pins in design.pins),
        held_border=any(pins.where == "border" for pins in design.pins),
        **vars(guess.reach) | {"warnings": warnings},
        share_at_bounds=found.share_at_bounds,
        first_guess=of_guess,
        unrounded=by_preview,
        preview=of_preview.record,
        exact=None if verification is None else of_result.record,
        other_exact=_other(verification, distance),
        exact_agrees=None if verification is None else verification.summary.starts_agree,
        interrupted=is_interrupted,
        reached=bool(of_result.mean_percent <= settings.within_percent and result.summary.is_minimum),
        within_percent=settings.within_percent,
        rounding_loss_percent=loss,
        steps=search.steps,
        corrections=correction.done,
        restarts=search.restarts,
        version=__version__,
        design=design.to_dict(),
    )
    fitted = Fit(design, target, guess, shape, verification, of_result, summary)
    if is_interrupted:
        raise FitInterrupted(fitted) from None
    return fitted


def _rounded(base: Design, sizes: StarUnknowns, printer: Printer, tell: Say) -> Design:
    """A design without its sizes that rounds them to the printer."""
    rounding = choose_rounding(layout(sizes.design(base)), printer)
    tell(f"rounding to layers of {rounding.layer_mm:g} mm on {rounding.first_layer_mm:g} mm")
    return with_rounding(base, rounding)


def _other(verification: Verification | None, distance: Callable[[Shape], FitDistance]) -> TargetDistanceRecord | None:
    """Distance of the exact minimum that is not the result; None if both starts lead to one."""
    if verification is None or verification.summary.starts_agree:
        return None
    return distance(next(shape for name, shape in verification.exact.items() if name != verification.result)).record


def _warnings(sizes: StarUnknowns, distance: FitDistance, verification: Verification | None) -> list[str]:
    """What limits the fit, one line each."""
    lines = []
    # a warning names the share of stars at the ends of the law's lengths from this one on
    if sizes.share_at_bounds > 0.1:
        share = 100 * sizes.share_at_bounds
        lines.append(f"{share:.0f} % of the stars have the shortest or the longest arms that the law covers")
    # % of the diameter, largest distance from which on a warning names its place
    if (largest := distance.record.largest_percent) > 4.0:
        lines.append(
            f"the largest distance, {largest:.1f} % of the diameter, is at {place_text(distance.farthest, 0)}: more "
            "needles hold a rim, a larger target has more stars"
        )
    if verification is not None and verification.summary.starts_distance_percent > MAX_FORM_DISTANCE_PERCENT:
        apart = verification.summary.starts_distance_percent
        lines.append(f"two forms: a print may rest in another one, {apart:.1f} % of the diameter away")
    return lines
