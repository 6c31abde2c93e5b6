"""Verification, fit, export and report, as a page asks for them."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol

from asterism.pattern.design.files import plain
from asterism.studio import requests as ask
from asterism.studio.document import Document
from asterism.studio.fit_result import FitResult
from asterism.studio.frame_parts import FrameParts
from asterism.studio.job_messages import VERIFIED, Computed, Fitted, JobProgress, Verified, Written
from asterism.studio.jobs import Jobs, RunningJob
from asterism.studio.messages import StudioProblem
from asterism.studio.page_data import engine_problem_data, failure_data
from asterism.studio.request import Request, RequestError
from asterism.studio.shown import Shown
from asterism.studio.tab import Tabs
from asterism.studio.weights import sheet_weights

VERIFICATION_PROCESS = "asterism.studio.verifier:run_verification"
FIT_PROCESS = "asterism.studio.fitter:run_fit"
EXPORT_PROCESS = "asterism.studio.writers:run_export"
REPORT_PROCESS = "asterism.studio.writers:run_report"
EXPORT_OPTIONS = {
    "printer",
    "plastic",
    "preview",
    "first_layer_mm",
    "layer_mm",
    "plate_mm",
    "fabric_mm",
    "turn_deg",
    "needle_spacing_mm",
    "border",
}


class JobOwner(Protocol):
    """What a job needs of the studio."""

    folder: Path
    printer: str
    shown: Shown
    tabs: Tabs
    parts: FrameParts
    fits: FitResult

    document: Document | None

    def tell(self, message: dict[str, Any]) -> None: ...
    def tell_state(self) -> None: ...


class JobRequests:
    """Starts jobs, and sends their progress and their results to all pages."""

    def __init__(self, studio: JobOwner) -> None:
        self._studio = studio
        self._document: Document | None = None  # of the last job
        self._jobs = Jobs(self._tell)

    def start(self, request: Request, document: Document) -> None:
        """Start a job.

        Raises
        ------
        RequestError
            Another job is running, or an option does not exist.
        """
        table, folder, stem = document.table, str(document.path.parent), document.path.stem
        place = document.path.parent
        match request:
            case ask.Verify():
                out = str(place / f"{stem}{VERIFIED}")
                started = self._jobs.start("verify", document.revision, VERIFICATION_PROCESS, table, folder, out)
            case ask.FitRequest():
                target = self._studio.parts.target
                if target is None:
                    raise RequestError("target: send a file first")
                weights = sheet_weights(table, document.layout, self._studio.shown.sheet, target)
                arguments = (target.surface_of_file, target.name, request.hold, self._studio.printer, weights)
                started = self._jobs.start("fit", document.revision, FIT_PROCESS, *arguments)
                if started:
                    self._studio.fits.begin(document)
            case ask.ExportRequest():
                options = self._export_options(request)
                out = str(place / f"{stem}-print")
                started = self._jobs.start("export", document.revision, EXPORT_PROCESS, table, folder, out, options)
            case ask.ReportRequest():
                out = str(place / f"{stem}.pdf")
                started = self._jobs.start(
                    "report", document.revision, REPORT_PROCESS, table, folder, out, self._studio.printer
                )
            case _:
                raise RequestError("the server does not do that")
        if not started:
            raise RequestError("wait for the running job, or cancel it")
        self._document = document

    def _export_options(self, request: ask.ExportRequest) -> dict[str, Any]:
        options = {"printer": self._studio.printer, **request.options}
        options |= {
            key: value
            for key, value in (("printer", request.printer), ("plastic", request.plastic))
            if value is not None
        }
        if unknown := sorted(set(options) - EXPORT_OPTIONS):
            raise RequestError(f"export: {unknown[0]!r} is not one of {', '.join(sorted(EXPORT_OPTIONS))}")
        for name in ("printer", "plastic"):
            # a name, never a file: names come from outside
            if not isinstance(options.get(name, "x"), str) or not options.get(name, "x").replace("-", "").isalnum():
                raise RequestError(f"export: {name} must be the name of a profile")
        return options

    def cancel(self) -> None:
        """End the running job."""
        if (job := self._jobs.cancel()) is not None:
            self._studio.tell({"type": "result", "job": job.kind, "cancelled": True})
            self._studio.tell_state()

    def _tell(self, job: RunningJob, message: Any) -> None:
        """Pass on a message of a job. A failure becomes a message of its own, since no caller handles an exception."""
        studio = self._studio
        try:
            self._pass_on(job, message)
        except Exception as error:
            studio.tell({**failure_data(error, None, f"a message of the job {job.kind}"), "job": job.kind})
            studio.tell({"type": "result", "job": job.kind, "failed": True})
            studio.tell_state()

    def _pass_on(self, job: RunningJob, message: Any) -> None:
        studio, document = self._studio, self._document
        other = None if document is None or document is studio.document else document.path.stem
        match message:
            case JobProgress():
                studio.tell({"type": "progress", **job.progress_data})
                return
            case StudioProblem():
                problem = engine_problem_data(message)
                if other is not None:  # its field, stars and place are not those of the design that is open
                    problem |= {"text": f"{other}: {message.text}", "field": "", "stars": (), "at_mm": None}
                studio.tell({**problem, "job": job.kind})
                studio.tell({"type": "result", "job": job.kind, "failed": True})
            case Verified() | Computed() if other is not None:
                text = f"The verification of {other} is done; its files are beside that design."
                studio.tell({"type": "note", "text": text})
                studio.tell({"type": "result", "job": job.kind, "failed": True})
            case Verified():
                studio.shown.show_verified(message, job.revision, studio.tabs)
                files = [Path(name) for name in message.files]
                self._finish(job, message.summary, files, ())
            case Computed():
                studio.shown.add_mesh(message.mesh)
                studio.shown.add_frame(message.frame, job.revision, studio.tabs)
                studio.shown.add_summary(message.shown, job.revision)
                self._finish(job, message.summary, [Path(name) for name in message.files], ())
            case Fitted():
                studio.fits.take(message)
            case Written():
                self._finish(
                    job, message.summary, [Path(message.folder) / name for name in message.files], message.warnings
                )
        studio.tell_state()

    def _finish(self, job: RunningJob, summary: dict[str, Any], files: list[Path], warnings: tuple[str, ...]) -> None:
        root = self._studio.folder
        listed = [
            {"name": file.resolve().relative_to(root).as_posix(), "size": file.stat().st_size}
            for file in files
            if file.resolve().is_relative_to(root) and file.is_file()
        ]
        self._studio.tell(
            {
                "type": "result",
                "job": job.kind,
                "revision": job.revision,
                "summary": plain(summary),
                "files": listed,
                "warnings": list(warnings),
                "report": next((entry["name"] for entry in listed if str(entry["name"]).endswith("report.html")), None),
            }
        )

    def data(self) -> dict[str, Any]:
        """The running job and its progress, for the message `state`."""
        job = self._jobs.running
        return {} if job is None else {job.kind: {"revision": job.revision, **job.progress_data}}

    def close(self) -> None:
        """End what is running."""
        self._jobs.close()
