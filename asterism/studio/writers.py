"""Processes that write files for a design: the export for the printer, and the page about the design."""

from __future__ import annotations

import time
from collections.abc import Callable
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from asterism.equilibrium.errors import Error
from asterism.studio.engine_problem import engine_problem
from asterism.studio.job_messages import JobProgress, Written


def run_export(
    connection: Connection, job: int, table: dict[str, Any], folder: str, out: str, options: dict[str, Any]
) -> None:
    """Write all files for the print into `out`; see `asterism.print.export.export` for the options."""

    def work(say: Callable[[str], None]) -> Written:
        from asterism.pattern.design.design import Design
        from asterism.print.export import export

        exported = export(Design.from_dict(table, folder), out, say=say, **options)
        return Written(job, exported.summary.to_json(), out, tuple(exported.files), exported.warnings)

    _run(connection, job, "export", work)


def run_report(connection: Connection, job: int, table: dict[str, Any], folder: str, out: str, printer: str) -> None:
    """Write the page about the design, a PDF, as `out`."""

    def work(say: Callable[[str], None]) -> Written:
        from asterism.pattern.design.design import Design
        from asterism.reports.design_report import report

        report(Design.from_dict(table, folder), out, printer=printer, say=say)
        path = Path(out)
        return Written(job, {}, str(path.parent), (path.name,))

    _run(connection, job, "report", work)


def _run(connection: Connection, job: int, stage: str, work: Callable[[Callable[[str], None]], Written]) -> None:
    """Send progress while the work is done, and what came of it."""
    begun = time.monotonic()

    def say(text: str) -> None:
        connection.send(JobProgress(job, text, 0, 0, time.monotonic() - begun))

    say(stage)
    try:
        connection.send(work(say))
    except Error as error:
        connection.send(engine_problem(job, error))
