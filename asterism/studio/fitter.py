"""A fit to the target surface in a process of its own; to cancel it, the server ends the process."""

from __future__ import annotations

from multiprocessing.connection import Connection

from asterism.fitting.fit import fit
from asterism.fitting.target import TargetSurface
from asterism.print.profiles import load_printer
from asterism.studio.engine_orders import Surface
from asterism.studio.engine_problem import engine_problem
from asterism.studio.job_messages import Fitted
from asterism.studio.requests import Hold
from asterism.studio.verifier import ProgressSender
from asterism.studio.weights import SheetWeights


def run_fit(
    connection: Connection,
    job: int,
    target: Surface,
    name: str,
    hold: Hold,
    printer: str,
    weights: SheetWeights | None = None,
) -> None:
    """The body of a fit's process. The exact model is left to a verification.

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
    progress = ProgressSender(connection, job)
    progress("reading the target", 0, 0)
    try:
        surface = TargetSurface.of_triangles(target.vertices, target.triangles, name)
        fitted = fit(
            surface,
            needles=0 if hold == "nothing" else None,
            border=True if hold == "border" else None,
            printer=load_printer(printer),
            exact=False,
            weight=None if weights is None else weights.at_vertices(surface),
            say=lambda line: progress(line, 0, 0),
        )
    except Exception as error:
        connection.send(engine_problem(job, error))
        return
    summary = fitted.summary.to_json()
    table = summary.pop("design")
    connection.send(Fitted(job, summary, table, surface.motion, surface.shift_mm))
