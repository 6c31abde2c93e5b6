"""The jobs of the studio: verification, fit, export and report, each in a process of its own.

To cancel a job, the server ends its process. A function imports what its job needs: the solvers take most of a second.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism.equilibrium.errors import Error
from asterism.homogenize.errors import LawError
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.studio.engine_problem import engine_problem
from asterism.studio.messages import VERIFIED, Computed, Fitted, JobProgress, Surface, Verified, Written
from asterism.studio.requests import Hold
from asterism.studio.weights import SheetWeights

if TYPE_CHECKING:
    from asterism.verification.verification import Verification


class ProgressSender:
    """Sends how far a job is, and not more often than a page can show it."""

    def __init__(self, connection: Connection, job: int) -> None:
        self._connection, self._job = connection, job
        self._begun, self._sent = time.monotonic(), -np.inf
        self._last: tuple[str, int] = ("", -1)

    def __call__(self, stage: str, done: int, of: int) -> None:
        """Report `done` of `of` steps of a stage."""
        now = time.monotonic()
        is_new = stage != self._last[0] or done >= of
        if is_new or (done != self._last[1] and now - self._sent > 0.1):
            self._last, self._sent = (stage, done), now
            self._connection.send(JobProgress(self._job, stage, done, of, now - self._begun))


def run_verification(connection: Connection, job: int, table: dict[str, Any], folder: str, out: str) -> None:
    """Verify a design. A pattern without a preview has nothing to verify: its exact shape is computed.

    Parameters
    ----------
    connection : the process's end of a pipe; it gets `JobProgress` and at the end `Verified`, `Computed` or
        `StudioProblem`.
    job : number of the job.
    table : of the design file.
    folder : of the design file, for pictures.
    out : directory of the results. Those of a pattern without a preview go beside it: `-exact` replaces `VERIFIED`.
    """
    from asterism.reports.verification_page import write_verification
    from asterism.results.files import check_writable
    from asterism.verification.run import verify

    progress = ProgressSender(connection, job)
    design: Design | None = None
    try:
        progress("design", 0, 1)
        design = Design.from_dict(table, folder)
        check_writable(out)
        try:
            verification = verify(design, progress=progress)
        except (DesignError, LawError):
            if design.rods is None:
                raise
            connection.send(_computed(job, design, f"{out.removesuffix(VERIFIED)}-exact", progress))
            return
        progress("report", 0, 1)
        files = write_verification(verification, out)
    except Exception as error:
        connection.send(engine_problem(job, error, design))
        return
    connection.send(verified(job, verification, tuple(str(Path(out) / name) for name in files)))


def _computed(job: int, design: Design, out: str, progress: ProgressSender) -> Computed:
    """The message with the exact shape of a pattern without a preview. Its mesh has the number of a verification's."""
    from asterism.exact.simulation import exact_shape
    from asterism.reports.write_results import write_results
    from asterism.studio.shape_frame import shape_messages
    from asterism.studio.summaries import exact_summary
    from asterism.verification.progress import ExactProgress

    counted = ExactProgress("exact model", progress)
    shape = exact_shape(design, report=counted.report)
    counted.finish()
    progress("files", 0, 1)
    files = write_results(shape, out)
    mesh, frame = shape_messages(shape, number=-job, stage="exact")
    paths = tuple(str(Path(out) / name) for name in files)
    return Computed(job, shape.summary.to_json(), mesh, frame, exact_summary(shape), paths)


def verified(job: int, verification: Verification, files: tuple[str, ...]) -> Verified:
    """The message with both shapes at the vertices of the exact one, and the distance of their cell means.

    The number of the mesh is negative, unlike those of the engine.
    """
    from asterism.studio.sheet_marks import mesh_message

    comparison = verification.comparison
    exact = comparison.reference
    mesh = mesh_message(-job, exact.printed, exact.triangles, np.empty(0, dtype=np.int64), is_fine=True)
    return Verified(
        job=job,
        summary=verification.summary.to_json(),
        mesh=mesh,
        exact=exact.positions.astype(np.float32),
        preview=comparison.other.at(exact.printed).astype(np.float32),
        distance=comparison.distance_mm.astype(np.float32),
        files=files,
    )


def run_fit(
    connection: Connection,
    job: int,
    target: Surface,
    name: str,
    hold: Hold,
    printer: str,
    weights: SheetWeights | None = None,
) -> None:
    """Fit a design to the target surface. The exact model is left to a verification.

    Parameters
    ----------
    connection : the process's end of a pipe; it gets `JobProgress` and at the end `Fitted` or `StudioProblem`.
    job : number of the job.
    target : in the pose and unit of its file, but in mm.
    name : of the target, for messages.
    hold : needles by the outline or a held border (`auto`), the whole border, or nothing.
    printer : name of the profile to whose layers and lines sizes are rounded.
    weights : of places of the sheet; by default all count alike.
    """
    from asterism.fitting.fit import fit
    from asterism.fitting.settings import FitSettings
    from asterism.fitting.target import TargetSurface
    from asterism.print.profiles import load_printer

    progress = ProgressSender(connection, job)
    progress("reading the target", 0, 0)
    try:
        surface = TargetSurface.of_triangles(target.vertices, target.triangles, name)
        if weights is not None:
            surface = surface.weighted(weights.at_vertices(surface))
        held = {"nothing": {"needles": 0}, "border": {"border": True}}.get(hold, {})
        settings = FitSettings(exact=False, **held)
        fitted = fit(surface, settings, printer=load_printer(printer), say=lambda line: progress(line, 0, 0))
    except Exception as error:
        connection.send(engine_problem(job, error))
        return
    summary = fitted.summary.to_json()
    table = summary.pop("design")
    connection.send(Fitted(job, summary, table, surface.motion, surface.shift_mm))


def run_export(
    connection: Connection, job: int, table: dict[str, Any], folder: str, out: str, options: dict[str, Any]
) -> None:
    """Write all files for the print into `out`; see `asterism.print.export.export` for the options."""

    def work(say: Callable[[str], None]) -> Written:
        from asterism.print.export import export

        exported = export(Design.from_dict(table, folder), out, say=say, **options)
        return Written(job, exported.summary.to_json(), out, tuple(exported.files), exported.warnings)

    _write(connection, job, "export", work)


def run_report(connection: Connection, job: int, table: dict[str, Any], folder: str, out: str, printer: str) -> None:
    """Write the page about the design, a PDF, as `out`."""

    def work(say: Callable[[str], None]) -> Written:
        from asterism.reports.design_report import report

        report(Design.from_dict(table, folder), out, printer=printer, say=say)
        path = Path(out)
        return Written(job, {}, str(path.parent), (path.name,))

    _write(connection, job, "report", work)


def _write(connection: Connection, job: int, stage: str, work: Callable[[Callable[[str], None]], Written]) -> None:
    """Send progress while files are written, and what came of it."""
    progress = ProgressSender(connection, job)
    progress(stage, 0, 0)
    try:
        connection.send(work(lambda line: progress(line, 0, 0)))
    except Error as error:
        connection.send(engine_problem(job, error))
