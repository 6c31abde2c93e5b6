"""The shape of the rounded design from the exact model or the preview, and its change by rounding."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.any_law import AnyLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import free_motions
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.off_sheet import off_sheet_mm
from asterism.pattern.layout.symmetric_distance import distances_of_images, symmetric_distances
from asterism.pattern.layout.symmetries import symmetries
from asterism.print.job import Job
from asterism.process.listeners import Say
from asterism.results.records.export import ShapeChangeRecord
from asterism.shape.shape import Shape


def shape_change(drawn: Shape, printed: Shape, design: Design, plan: Layout, model: str) -> ShapeChangeRecord:
    """Compare the shape of the rounded design with that of the design as drawn, both as their supports hold them.

    Parameters
    ----------
    drawn, printed : the shapes before and after rounding.
    design, plan : the design and layout before or after rounding; both have the same stars.
    model : model of both shapes: `exact` or `preview`.
    """
    supports = plan.support_samples
    off_sheet = off_sheet_mm(plan, min(len(drawn.printed), len(printed.printed)))
    free = free_motions(supports, drawn.at(supports.printed, off_sheet), design.gravity.pull)
    same = symmetries(design, plan)
    if plan.drawn is None:
        before, after = drawn.positions[drawn.star_vertices], printed.positions[printed.star_vertices]
        distance = float(symmetric_distances(before, after, same, free).min()) if len(before) > 2 else 0.0
    else:
        at = plan.points_on_rods
        before, after_at = drawn.at(at, off_sheet), partial(printed.at, off_sheet_mm=off_sheet)
        distance = float(distances_of_images(at, before, after_at, same, free).min())
    change = ShapeChangeRecord(
        model=model,
        height_mm=[drawn.height_mm, printed.height_mm],
        extent_mm=[list(drawn.extent_mm), list(printed.extent_mm)],
        star_distance_mm=distance,
        star_distance_percent=100.0 * distance / diameter(drawn.positions),
        are_minima=[bool(shape.summary.get("is_minimum", False)) for shape in (drawn, printed)],
        stars_outside_law=len(
            printed.summary.get("stars_outside_law", ()) or drawn.summary.get("stars_outside_law", ())
        ),
        warnings=list(printed.summary.get("warnings", [])),
    )
    return change.changed(minima=printed.summary["minima"]) if model == "exact" else change


Found = tuple[Shape | None, ShapeChangeRecord | None]


def printed_shape(
    job: Job,
    preview: bool,
    simulate: bool,
    law: AnyLaw | None = None,
    report: Callable[[str, Any], None] | None = None,
    say: Say | None = None,
) -> Found:
    """The shape of the rounded design, and its distance from the shape of the design as drawn.

    Parameters
    ----------
    preview, simulate : compute the shape with the preview or with the exact model. Without either, the preview is
        computed if rounding changes the design, or if there are needles.
    law : law of the preview; that of the paper's material by default.
    report, say : called with the progress of the exact model, as in `asterism.verification.both_starts.simulate`.

    Returns
    -------
    The printed shape and its change, or None for each that was not computed. If the preview has no law for the fabric
    or the pattern, the change has the `model` None and the reason in `why`.

    Raises
    ------
    LawError
        `preview` is set, and the preview has no law for this fabric.
    """
    if simulate:
        # the imports of the exact model take seconds
        from asterism.verification.both_starts import simulate as solve

        return _both(job, lambda plan: solve(plan, report=report, say=say, law=law), "exact")
    if not (preview or job.is_rounded or (job.needles and job.shape is None)):
        return None, None
    from asterism.previews.run import preview as fast

    try:
        return _both(job, lambda plan: fast(plan, law), "preview")
    except (LawError, DesignError) as error:
        if preview:
            raise
        return None, ShapeChangeRecord(model=None, why=" ".join(str(error).split()), are_minima=[])


def _both(job: Job, shape_of: Callable[[Design], Shape], model: str) -> tuple[Shape, ShapeChangeRecord]:
    printed = shape_of(job.design)
    drawn = shape_of(job.drawn) if job.is_rounded else printed
    return printed, shape_change(drawn, printed, job.design, job.plan, model)
