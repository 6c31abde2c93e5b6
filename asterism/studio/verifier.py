"""A verification in a process of its own; to cancel it, the server ends the process.

A pattern without a preview has nothing to verify: the process computes its exact shape.
"""

from __future__ import annotations

import time
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from asterism.exact.simulation import exact_shape
from asterism.homogenize.errors import LawError
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.reports.verification_files import write_verification
from asterism.reports.write_results import write_results
from asterism.results.files import check_writable
from asterism.studio.engine_problem import engine_problem
from asterism.studio.job_messages import VERIFIED, Computed, JobProgress, Verified
from asterism.studio.rest_summary import exact_summary
from asterism.studio.shape_frame import shape_messages
from asterism.studio.shown_mesh import mesh_message
from asterism.verification.progress import ExactProgress
from asterism.verification.run import verify
from asterism.verification.verification import Verification

PROGRESS_EVERY_S = 0.1  # at most, within a stage


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
        if is_new or (done != self._last[1] and now - self._sent > PROGRESS_EVERY_S):
            self._last, self._sent = (stage, done), now
            self._connection.send(JobProgress(self._job, stage, done, of, now - self._begun))


def run_verification(connection: Connection, job: int, table: dict[str, Any], folder: str, out: str) -> None:
    """The body of a verification's process.

    Parameters
    ----------
    connection : the process's end of a pipe; it gets `JobProgress` and at the end `Verified`, `Computed` or
        `StudioProblem`.
    job : number of the job.
    table : of the design file.
    folder : of the design file, for pictures.
    out : directory of the results. Those of a pattern without a preview go beside it: `-exact` replaces `VERIFIED`.
    """
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
    counted = ExactProgress("exact model", progress)
    shape = exact_shape(design, report=counted.report, say=counted.say)
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
