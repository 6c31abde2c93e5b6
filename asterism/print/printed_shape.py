"""The shape of what is printed, from the exact model or the preview, and what rounding has changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from asterism.print.job import Job
from asterism.print.shape_change import shape_change
from asterism.results.records.export import ShapeChangeRecord
from asterism.shape.shape import Shape
from homogenize.errors import LawError
from homogenize.law.law import Law
from pattern.design.design import Design

Say = Callable[[str], None]
Report = Callable[[str, Any], None]
Found = tuple[Shape | None, ShapeChangeRecord | None]


def printed_shape(
    job: Job,
    preview: bool,
    simulate: bool,
    law: Law | None = None,
    report: Report | None = None,
    say: Say | None = None,
) -> Found:
    """The shape if it was asked for, and how far it is from that of the design before rounding.

    Parameters
    ----------
    preview, simulate : ask for the shape of the preview or of the exact model. Without either, the preview still says
        what rounding changes, if it changes anything, and whether the sheet hangs below its needles, if there are any.
    law : of the preview; that of the paper's material by default.
    report, say : called with the progress of the exact model, as in `asterism.exact.simulation.simulate`.

    Returns
    -------
    The printed shape, or None if none was computed; and `shape_change` with the `model` that it is from, or None. Where
    the preview has no law for the fabric, `model` is None and `why` says the reason.

    Raises
    ------
    LawError
        The preview was asked for and has no law for this fabric.
    """
    if simulate:
        # the exact model is imported where it is asked for: its imports take seconds
        from asterism.exact.simulation import simulate as solve

        return _both(job, lambda plan: solve(plan, report=report, say=say), "exact")
    if not (preview or job.is_rounded or (job.needles and job.shape is None)):
        return None, None
    from asterism.previews.run import preview as fast

    try:
        return _both(job, lambda plan: fast(plan, law), "preview")
    except LawError as error:
        if preview:
            raise
        return None, ShapeChangeRecord(model=None, why=" ".join(str(error).split()), are_minima=[])


def _both(job: Job, shape_of: Callable[[Design], Shape], model: str) -> tuple[Shape, ShapeChangeRecord]:
    printed = shape_of(job.design)
    drawn = shape_of(job.drawn) if job.is_rounded else printed
    return printed, shape_change(drawn, printed, job.design, job.plan, model)
