"""Verification: preview and exact shape of one design, computed and compared."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from asterism.discrete.release.continuation import Report
from asterism.discrete.release.levels import Ladder, SharedSearch
from asterism.equilibrium.newton.minimise import Iteration
from asterism.exact.simulation import exact_shape
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.law_choice import serving_law
from asterism.previews.session import preview
from asterism.previews.sheet import preview_layout
from asterism.process.compiling import clock_without_compiling
from asterism.process.listeners import Say, ignore_line
from asterism.process.version import __version__
from asterism.results.files import VERIFICATION_MODEL
from asterism.results.record import keys_of
from asterism.results.records.exact import ExactRecord
from asterism.results.records.verification import DifferenceRecord, VerificationRecord, VerifiedStartRecord
from asterism.shape.comparison import Comparison, compare_shapes
from asterism.shape.shape import Shape
from asterism.verification.verification import (
    PREVIEW,
    RELEASE,
    Verification,
    same_branch,
    same_minimum,
    verification_warnings,
)

STAGES = ("preview", "exact model from the flat print", "exact model from the preview", "comparison")

StageReport = Callable[[str, int, int], None]
# number of steps of a stage
WHOLE = 100
# share of the release on the coarsest mesh in the computing time of an exact shape; the finer meshes take the rest
RELEASE_SHARE = 0.5


class ExactProgress:
    """Counts the progress of an exact shape from the reports of `exact_shape`.

    Parameters
    ----------
    stage : name of the stage.
    tell : called with the stage, the number of completed steps, and the number of all steps.
    """

    def __init__(self, stage: str, tell: StageReport) -> None:
        self._stage, self._tell = stage, tell
        self._meshes: set[str] = set()
        self._done = 0
        tell(stage, 0, WHOLE)

    def report(self, text: str, iteration: Iteration) -> None:
        """Read the mesh and the share of the release from the name of a stage of `exact_shape`."""
        mesh, percent = re.match(r"(\d+) vertices", text), re.search(r"(\d+) %", text)
        if percent:
            share = RELEASE_SHARE * int(percent[1]) / 100.0
        else:  # each mesh takes a part of what the meshes before have left
            self._meshes.add(mesh[1] if mesh else "")
            # share of the finer meshes that are left after each mesh; how many there will be is not known
            share = RELEASE_SHARE + (1.0 - RELEASE_SHARE) * (1.0 - 0.6 ** len(self._meshes))
        # an unfinished stage stays below 100 %, and a repeated stage does not decrease the count
        self._done = max(self._done, min(int(WHOLE * share), WHOLE - 1))
        self._tell(self._stage, self._done, WHOLE)

    def finish(self) -> None:
        """Report that all steps are completed."""
        self._tell(self._stage, WHOLE, WHOLE)


def verify(
    design: Design,
    law: Law[Any] | None = None,
    backend: str = "auto",
    report: Report | None = None,
    say: Say | None = None,
    released: Shape | None = None,
    near: Shape | None = None,
    command: str | None = None,
    ready: Shape | None = None,
    progress: StageReport | None = None,
) -> Verification:
    """Compute the preview and two exact shapes, from the flat print and from the preview, and compare them.

    Parameters
    ----------
    law : law of the preview, as of `asterism.preview`.
    backend, report, say : as in `simulate`.
    released, near : exact shapes from the flat print and from the preview, if they are available already.
    command : command line, for the report.
    ready : a preview of this design, or another shape to compare instead, if it is available already.
    progress : called with the name of a stage, the number of completed steps, and the number of all steps. The stages
        are those of `STAGES`, in this order.

    Raises
    ------
    DesignError, MeshError, BackendError
        As in `simulate`.
    LawError
        The law is for another material.
    """
    tell, step = say or ignore_line, progress or (lambda stage, done, of: None)
    tell("preview")
    step(STAGES[0], 0, 1)
    with clock_without_compiling() as clock:
        begun = clock()
        plan = preview_layout(design)
        layout_s = clock() - begun
        if law is None and ready is None:
            law = serving_law(design, plan, say=tell)
        shared = SharedSearch(Ladder(design, plan))

        def timed(known: Shape | None, make: Callable[[], Shape], line: str = "") -> tuple[Shape, float]:
            """A shape and its computing time (s) with the shared layout; the recorded time if it is known."""
            if known is not None:
                return known, float(known.summary["wall_s"])
            if line:
                tell(line)
            begun = clock()
            return make(), clock() - begun + layout_s

        def solve(stage: str, near: Shape | None = None) -> Shape:
            counted = ExactProgress(stage, step)

            def reported(name: str, iteration: Iteration) -> None:
                counted.report(name, iteration)
                if report:
                    report(name, iteration)

            shape = exact_shape(design, backend, reported, tell, near=near, plan=plan, shared=shared)
            counted.finish()
            return shape

        quick, preview_s = timed(ready, lambda: preview(design, law, plan=plan))
        tell(f"preview done in {preview_s:.2f} s")
        step(STAGES[0], 1, 1)
        released, exact_s = timed(released, lambda: solve(STAGES[1]), "exact model, released from the flat print")
        near, near_s = timed(near, lambda: solve(STAGES[2], quick), "exact model, started from the preview")
    tell("comparing")
    step(STAGES[3], 0, 1)
    same, pull = symmetries(design, plan), design.gravity.pull
    exact = {RELEASE: released, PREVIEW: near}
    by_release = compare_shapes(released, quick, plan, same, pull)
    comparisons = {RELEASE: by_release, PREVIEW: compare_shapes(near, quick, plan, same, pull, by_release.mean)}
    verification = Verification(design, quick, exact, comparisons)
    agree, between = same_minimum(released, near, plan, same, pull, by_release.mean)
    seconds = {"preview_s": preview_s, "exact_s": exact_s, "exact_from_preview_s": near_s}
    step(STAGES[3], 1, 1)
    return replace(verification, summary=_summary(verification, between, agree, seconds, command))


def _summary(
    verification: Verification,
    between: Comparison,
    agree: bool,
    seconds: dict[str, Any],
    command: str | None,
) -> VerificationRecord:
    result, other = verification.result, next(name for name in verification.exact if name != verification.result)
    exact = ExactRecord.from_json(verification.exact[result].summary)
    # a start that ends without a minimum has no form to compare with
    with_other = verification.comparisons[other].record if verification.exact[other].summary["is_minimum"] else None
    form = same_branch(verification.comparison.record, with_other, between.rms_percent) if exact.is_minimum else None
    preview = verification.preview.summary
    of_start = keys_of(VerifiedStartRecord).keys() - keys_of(DifferenceRecord).keys()
    return VerificationRecord(
        model=VERIFICATION_MODEL,
        **vars(verification.comparison.record),
        same_branch=form,
        speedup=seconds["exact_s"] / seconds["preview_s"],
        **seconds,
        mesh_error_percent=exact.mesh_error_percent,
        mesh_change_percent=exact.get("mesh_change_percent"),
        expected_rms_percent=preview.get("expected_rms_percent"),
        expected_height_percent=preview.get("expected_height_percent"),
        result_from=result,
        starts_agree=agree,
        starts_distance_percent=between.rms_percent,
        starts={
            name: VerifiedStartRecord(
                **vars(verification.comparisons[name].record),
                **{key: shape.summary[key] for key in of_start if key in shape.summary},
            )
            for name, shape in verification.exact.items()
        },
        warnings=verification_warnings(verification, between.rms_percent),
        version=__version__,
        preview=preview,
        exact=exact,
        design=verification.design.to_dict(),
        command=command,
    )
