"""The jobs of the studio, such as verification, fit and export, each in a process of its own.

To cancel a job, the server ends its process. A function imports what its job needs: the solvers take most of a second.
"""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.results.words import shape_in_words
from asterism.studio.engine_problem import engine_problem
from asterism.studio.messages import Fitted, JobProgress, Settled, Surface, Written
from asterism.studio.requests import Hold
from asterism.studio.weights import SheetWeights

if TYPE_CHECKING:
    from asterism.shape.shape import Shape


ANIMATION_PX = (1200, 900)


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


def settled(
    job: int, exact: Shape, near: Shape | None, pose: tuple[Array, Array] | None = None, smooth: bool = False
) -> Settled:
    """The message with an exact shape. The number of the mesh is negative, unlike those of the engine."""
    from asterism.studio.shape_frame import settled_messages
    from asterism.studio.summaries import exact_summary

    mesh, frame = settled_messages(exact, near, pose, -job, smooth)
    return Settled(job, mesh, frame, exact_summary(exact), pickle.dumps(exact))


def run_verification(
    connection: Connection,
    job: int,
    table: dict[str, Any],
    folder: str,
    out: str,
    pose: tuple[Array, Array] | None = None,
) -> None:
    """Verify a design.

    Parameters
    ----------
    connection : the process's end of a pipe; it gets `JobProgress` and at the end `Settled` or `StudioProblem`.
    job : number of the job.
    table : of the design file.
    folder : of the design file, for pictures.
    out : directory of the results.
    pose : as in `Settle`.
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
        verification = verify(design, progress=progress)
        progress("report", 0, 1)
        files = tuple(str(Path(out) / name) for name in write_verification(verification, out))
        message = settled(job, verification.exact[verification.result], verification.preview, pose)
        connection.send(replace(message, summary=verification.summary.to_json(), files=files))
    except Exception as error:
        connection.send(engine_problem(job, error, design))


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
    from asterism.print.printer import load_printer

    progress = ProgressSender(connection, job)
    progress("reading the target", 0, 0)
    try:
        surface = TargetSurface.of_triangles(target.vertices, target.triangles, name)
        if weights is not None:
            surface = surface.weighted(weights.at_vertices(surface))
        settings = FitSettings(
            exact=False, needles=0 if hold == "nothing" else None, border=True if hold == "border" else None
        )
        fitted = fit(surface, settings, printer=load_printer(printer), say=lambda line: progress(line, 0, 0))
    except Exception as error:
        connection.send(engine_problem(job, error))
        return
    summary = fitted.summary.to_json()
    table = summary.pop("design")
    connection.send(Fitted(job, summary, table, surface.motion, surface.shift_mm))


def run_export(
    connection: Connection,
    job: int,
    table: dict[str, Any],
    folder: str,
    out: str,
    options: dict[str, Any],
    exact: bytes | None = None,
) -> None:
    """Write all files for the print into `out`; see `asterism.print.export.export` for the options.

    Parameters
    ----------
    exact : the exact shape of the design, pickled; it takes the place of a preview.
    """

    def work(say: Callable[[str], None]) -> Written:
        from asterism.print.export import export

        if exact is not None and options.pop("preview", False):
            options["shape"] = pickle.loads(exact)
        exported = export(Design.from_dict(table, folder), out, say=say, **options)
        seen = exported.job.shape
        state = {"shape_state": None if seen is None else shape_in_words(seen.summary)}
        return Written(job, exported.summary.to_json() | state, out, tuple(exported.files), exported.warnings)

    _write(connection, job, "export", work)


def run_report(
    connection: Connection,
    job: int,
    table: dict[str, Any],
    folder: str,
    out: str,
    printer: str,
    exact: bytes | None = None,
) -> None:
    """Write the page about the design, a PDF, as `out`; about its exact shape, if it is given."""

    def work(say: Callable[[str], None]) -> Written:
        from asterism.reports.design_report import report

        results = None if exact is None else pickle.loads(exact)
        report(Design.from_dict(table, folder), out, results=results, printer=printer, say=say)
        path = Path(out)
        return Written(job, {}, str(path.parent), (path.name,))

    _write(connection, job, "report", work)


def run_animation(connection: Connection, job: int, out: str, exact: bytes) -> None:
    """Draw the release from the flat print to a shape, pickled, as the GIF `out`."""

    def work(say: Callable[[str], None]) -> Written:
        from asterism.results.files import write_file
        from asterism.shape.release_picture import release_gif

        path = Path(out)
        title = path.stem.removesuffix("-release")
        write_file(path, release_gif(pickle.loads(exact), "oblique", ANIMATION_PX, False, title))
        return Written(job, {}, str(path.parent), (path.name,))

    _write(connection, job, "drawing the release", work)


def run_spread(connection: Connection, job: int, out: str, exact: bytes) -> None:
    """Compute the range of shapes of prints about an exact shape, pickled, and draw it as the PNG `out`."""

    def work(say: Callable[[str], None]) -> Written:
        from asterism.exact.spread import spread
        from asterism.reports.spread_picture import draw_spread
        from asterism.results.files import staged
        from asterism.results.records.exact import ExactRecord

        shape, path = pickle.loads(exact), Path(out)
        known = set(shape.summary["warnings"])
        summary = spread(shape, say=say).summary
        assert isinstance(summary, ExactRecord)
        with staged(path.parent) as folder:
            draw_spread(summary.spread, summary["design"]["name"], folder / path.name)
        warnings = tuple(line for line in summary["warnings"] if line not in known)
        return Written(job, {"rows": summary.spread.rows_in_words()}, str(path.parent), (path.name,), warnings)

    _write(connection, job, "range of prints", work)


def _write(connection: Connection, job: int, stage: str, work: Callable[[Callable[[str], None]], Written]) -> None:
    """Send progress while files are written, and what came of it."""
    progress = ProgressSender(connection, job)
    progress(stage, 0, 0)
    try:
        connection.send(work(lambda line: progress(line, 0, 0)))
    except Error as error:
        connection.send(engine_problem(job, error))
