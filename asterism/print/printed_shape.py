"""The shape of the rounded design from the exact model or the preview, and its change by rounding."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.any_law import AnyLaw
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.print.job import Job
from asterism.print.shape_change import shape_change
from asterism.process.listeners import Say
from asterism.results.records.export import ShapeChangeRecord
from asterism.shape.shape import Shape

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
