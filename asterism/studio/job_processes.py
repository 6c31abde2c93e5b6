"""What the processes of the studio beside the engine do: one computes exact shapes and stays, others do one job each.

A function imports what it needs: the solvers take most of a second. The body of a job is called with the process's end
of a pipe, the number of the job, and the arguments that its docstring names. The pipe gets `JobProgress` and at the end
the message that the function returns, or `StudioProblem`. To cancel a job, the server ends its process.
"""

from __future__ import annotations

import pickle
import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from asterism.equilibrium.arrays import Array
from asterism.equilibrium.errors import Error
from asterism.pattern.design.design import Design
from asterism.process.settings import ExportSettings
from asterism.results.words import shape_in_words
from asterism.studio.answers import engine_problem
from asterism.studio.messages import Fitted, JobProgress, Released, Settle, Settled, Surface, Written
from asterism.studio.requests import Hold
from asterism.studio.target import SheetWeights

if TYPE_CHECKING:
    from asterism.shape.shape import Shape


class ProgressSender:
    """Sends how far a job is, and not more often than a page can show it."""

    def __init__(self, connection: Connection, job: int) -> None:
        self._connection, self._job = connection, job
        self._begun, self._sent = time.monotonic(), -np.inf
        self._last: tuple[str, int] = ("", -1)
        self.design: Design | None = None  # whose stars an error may name

    def __call__(self, stage: str, done: int, of: int) -> None:
        """Report `done` of `of` steps of a stage."""
        now = time.monotonic()
        is_new = stage != self._last[0] or done >= of
        if is_new or (done != self._last[1] and now - self._sent > 0.1):
            self._last, self._sent = (stage, done), now
            self._connection.send(JobProgress(self._job, stage, done, of, now - self._begun))

    def say(self, stage: str) -> None:
        """Report a stage without steps."""
        self(stage, 0, 0)


def job(stage: str) -> Callable[[Callable[..., Settled | Fitted | Written]], Callable[..., None]]:
    """The body of a process from a function of progress, number and arguments that returns the result of the job."""

    def body_of(work: Callable[..., Settled | Fitted | Written]) -> Callable[..., None]:
        @wraps(work)
        def body(connection: Connection, number: int, *arguments: Any) -> None:
            progress = ProgressSender(connection, number)
            progress.say(stage)
            try:
                connection.send(work(progress, number, *arguments))
            except Exception as error:
                if not isinstance(error, Error):
                    traceback.print_exc()
                connection.send(engine_problem(number, error, progress.design))

        return body

    return body_of


def settled(
    number: int, exact: Shape, near: Shape | None, pose: tuple[Array, Array] | None = None, smooth: bool = False
) -> Settled:
    """The message with an exact shape."""
    from asterism.studio.answers import exact_summary
    from asterism.studio.sheet_frames import exact_frame

    frame = exact_frame(exact, near, pose, smooth)
    return Settled(number, frame, exact_summary(exact), pickle.dumps(exact))


@job("design")
def run_verify(
    progress: ProgressSender,
    number: int,
    table: dict[str, Any],
    folder: str,
    out: str,
    pose: tuple[Array, Array] | None = None,
) -> Settled:
    """Verify the design of a table.

    Parameters
    ----------
    folder : of the design file, for pictures.
    out : directory of the results.
    pose : as in `Settle`.
    """
    from asterism.reports.verification_page import write_verification
    from asterism.results.files import check_writable
    from asterism.verification.verify import verify

    progress.design = design = Design.from_dict(table, folder)
    check_writable(out)
    verification = verify(design, progress=progress)
    progress("report", 0, 1)
    files = tuple(str(Path(out) / name) for name in write_verification(verification, out))
    message = settled(number, verification.exact[verification.result], verification.preview, pose)
    return replace(message, summary=verification.summary.to_json(), files=files)


@job("reading the target")
def run_fit(
    progress: ProgressSender,
    number: int,
    target: Surface,
    name: str,
    hold: Hold,
    printer: str,
    weights: SheetWeights | None = None,
) -> Fitted:
    """Fit a design to the target surface. The exact model is left to a verification.

    Parameters
    ----------
    target : in the pose and unit of its file, but in mm.
    name : of the target, for messages.
    hold : needles by the outline or a held border (`auto`), the whole border, or nothing.
    printer : name of the profile to whose layers and lines sizes are rounded.
    weights : of places of the sheet; by default all count alike.
    """
    from asterism.fitting.fit import fit
    from asterism.fitting.target import TargetSurface
    from asterism.print.printer import load_printer
    from asterism.process.settings import FitSettings

    surface = TargetSurface.of_triangles(target.vertices, target.triangles, name)
    if weights is not None:
        surface = surface.weighted(weights.at_vertices(surface))
    settings = FitSettings(
        exact=False, needles=0 if hold == "nothing" else None, border=True if hold == "border" else None
    )
    fitted = fit(surface, settings, printer=load_printer(printer), say=progress.say)
    summary = fitted.summary.to_json()
    return Fitted(number, summary, summary.pop("design"), surface.motion, surface.shift_mm)


@job("export")
def run_export(
    progress: ProgressSender,
    number: int,
    table: dict[str, Any],
    folder: str,
    out: str,
    settings: ExportSettings,
    exact: bytes | None = None,
) -> Written:
    """Write all files for the print into `out`.

    Parameters
    ----------
    exact : the exact shape of the design, pickled; it takes the place of a preview.
    """
    from asterism.print.export import export

    shape = None
    if exact is not None and settings.preview:
        settings, shape = replace(settings, preview=False), pickle.loads(exact)
    exported = export(Design.from_dict(table, folder), out, settings, shape=shape, say=progress.say)
    seen = exported.job.shape
    state = {"shape_state": None if seen is None else shape_in_words(seen.summary)}
    return Written(number, exported.summary.to_json() | state, out, tuple(exported.files), exported.warnings)


def _written(number: int, path: Path, summary: dict[str, Any] | None = None, warnings: tuple[str, ...] = ()) -> Written:
    """The message about one file."""
    return Written(number, summary or {}, str(path.parent), (path.name,), warnings)


@job("report")
def run_report(
    progress: ProgressSender,
    number: int,
    table: dict[str, Any],
    folder: str,
    out: str,
    printer: str,
    exact: bytes | None = None,
) -> Written:
    """Write the page about the design, a PDF, as `out`; about its exact shape, pickled, if it is given."""
    from asterism.reports.design_report import report

    results = None if exact is None else pickle.loads(exact)
    report(Design.from_dict(table, folder), out, results=results, printer=printer, say=progress.say)
    return _written(number, Path(out))


@job("drawing the release")
def run_animate(progress: ProgressSender, number: int, out: str, exact: bytes) -> Written:
    """Draw the release from the flat print to a shape, pickled, as the GIF `out`."""
    from asterism.results.files import write_file
    from asterism.shape.release_picture import release_gif

    path = Path(out)
    title = path.stem.removesuffix("-release")
    write_file(path, release_gif(pickle.loads(exact), "oblique", (1200, 900), False, title))
    return _written(number, path)


@job("range of prints")
def run_spread(progress: ProgressSender, number: int, out: str, exact: bytes) -> Written:
    """Compute the range of shapes of prints about an exact shape, pickled, and draw it as the PNG `out`."""
    from asterism.exact.spread import spread
    from asterism.reports.plots import draw_spread
    from asterism.results.files import staged
    from asterism.results.records.exact import ExactRecord

    shape, path = pickle.loads(exact), Path(out)
    known = set(shape.summary["warnings"])
    summary = spread(shape, say=progress.say).summary
    assert isinstance(summary, ExactRecord)
    with staged(path.parent) as folder:
        draw_spread(summary.spread, summary["design"]["name"], folder / path.name)
    warnings = tuple(line for line in summary["warnings"] if line not in known)
    return _written(number, path, {"rows": summary.spread.rows_in_words()}, warnings)


class _Newer(BaseException):
    """The shape is not wanted any more; no handler of errors on the way may keep it."""


def run_settling(connection: Connection) -> None:
    """Compute one exact shape after the other; a further message ends the one under way.

    Parameters
    ----------
    connection : the process's end of a pipe. It gets `Settle`, or None for no shape, and gives `JobProgress`, then
        `Settled` or `StudioProblem`, and then `Released` if that is asked for.
    """
    from asterism.exact.simulation import exact_shape
    from asterism.pattern import gallery

    exact_shape(gallery.load("star"))  # loads the compiled loops
    known: ExactForms | None = None
    while True:
        order: Settle | None = connection.recv()
        if order is None or connection.poll():
            continue
        design: Design | None = None
        try:
            design = Design.from_dict(order.table, order.folder)
            if known is None or not known.is_of(order):
                known = ExactForms(order, design, connection)
            connection.send(known.settled(order))
            # the release begins when the exact shape has been left alone for a second
            if order.release and (known.release is not None or not connection.poll(1.0)):
                connection.send(known.released(order))
        except _Newer:
            continue
        except Exception as error:
            connection.send(engine_problem(order.job, error, design))


class ExactForms:
    """The exact shape that follows the preview of an order, and the one that its release from the flat print leads to.

    The connection gets the progress; a message in it ends the computation.

    Raises
    ------
    Error
        The design has no exact shape.
    """

    def __init__(self, order: Settle, design: Design, connection: Connection) -> None:
        from asterism.discrete.release.levels import Ladder, SharedSearch
        from asterism.pattern.layout.build import layout

        self._order, self._design, self._connection = order, design, connection
        self._plan = layout(design)
        self._near: Shape | None = None if order.near is None else pickle.loads(order.near)
        self._search = SharedSearch(Ladder(design, self._plan))
        self._exact = self._solved("exact shape", order.job, self._near)
        self.release: tuple[Released, Shape | None] | None = None  # with the other shape, as soon as it is known

    def is_of(self, order: Settle) -> bool:
        """Whether an order is about the same design and preview."""
        return self._order.near == order.near and self._order.table == order.table

    def settled(self, order: Settle) -> Settled:
        """The exact shape that follows the preview."""
        return self._message(order, self._exact)

    def released(self, order: Settle) -> Released:
        """The shape that the release from the flat print leads to."""
        self.release = release, shape = self.release or self._released_from_print(order.job)
        other = None if shape is None else self._message(order, shape)
        return replace(release, job=order.job, other=other)

    def _released_from_print(self, job: int) -> tuple[Released, Shape | None]:
        from asterism.discrete.release.forms import SAME_FORM_PERCENT
        from asterism.pattern.layout.symmetries import symmetries
        from asterism.verification.verify import gap, same_minimum

        exact = self._exact
        try:
            shape = self._solved("release", job, None)
        except (Error, FloatingPointError):
            return Released(job, None), None
        if not shape.summary["is_minimum"]:
            return Released(job, None), None
        same = symmetries(self._design, self._plan)
        is_same, between = same_minimum(exact, shape, self._plan, same, self._design.gravity.pull)
        if is_same or (not exact.summary["is_minimum"] and between.rms_percent < SAME_FORM_PERCENT):
            return Released(job, True), None
        sign = 1.0 if shape.summary["energy_n_mm"] >= exact.summary["energy_n_mm"] else -1.0
        percent = sign * 100.0 * gap(exact.summary, shape.summary)
        return Released(job, False, None, percent, between.rms_percent), shape

    def _solved(self, stage: str, job: int, near: Shape | None) -> Shape:
        from asterism.exact.simulation import exact_shape
        from asterism.verification.verify import ExactProgress

        counted = ExactProgress(stage, ProgressSender(self._connection, job))

        def watched(name: str, iteration: Any) -> None:
            if self._connection.poll():
                raise _Newer
            counted.report(name, iteration)

        return exact_shape(self._design, report=watched, near=near, plan=self._plan, shared=self._search)

    def _message(self, order: Settle, shape: Shape) -> Settled:
        from asterism.studio.engine_frames import TargetComparison

        message = settled(order.job, shape, self._near, order.pose, order.parts.smooth)
        if order.parts.target is None:
            return message
        compared = TargetComparison(order.parts.target, order.parts.version)
        return replace(message, frame=compared.measured(message.frame, shape.weights))
