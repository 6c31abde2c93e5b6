"""Jobs beside the engine: verification, fit, export, report. One at a time, at low priority, and can be cancelled."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from asterism.pattern.design.files import plain
from asterism.results.files import clear_unfinished
from asterism.studio import requests as ask
from asterism.studio.child import Child
from asterism.studio.document import Document
from asterism.studio.messages import Fitted, JobProgress, Settled, StudioProblem, Written
from asterism.studio.page_data import elsewhere, problem_data
from asterism.studio.requests import Request, RequestError
from asterism.studio.shape_requests import StudioOwner, job_numbers
from asterism.studio.target import Target, sheet_weights

PROCESSES = {
    kind: f"asterism.studio.job_processes:run_{kind}"
    for kind in ("verify", "fit", "export", "report", "animate", "spread")
}


@dataclass
class RunningJob:
    """A job under way."""

    kind: str  # key of `PROCESSES`
    document: Document
    revision: int  # of the document, when the job began
    target: Target | None  # of then
    child: Child
    progress: JobProgress
    folders: tuple[Path, ...]  # that the job may make

    def clear(self) -> None:
        """End the process, and remove what it leaves unfinished."""
        self.child.close()
        clear_unfinished(self.document.path.parent)
        for folder in self.folders:
            clear_unfinished(folder)
            with suppress(OSError):  # it holds files, or there is none
                folder.rmdir()

    @property
    def progress_data(self) -> dict[str, Any]:
        """The progress as plain data for the page."""
        return {**asdict(self.progress), "job": self.kind}


class JobRequests:
    """Starts jobs, each in a process of its own, and sends their progress and their results to all pages."""

    def __init__(self, studio: StudioOwner) -> None:
        self._studio = studio
        self._running: RunningJob | None = None
        self._taking: asyncio.Task[None] | None = None  # shows the result of a fit

    def start(self, request: Request, document: Document) -> None:
        """Start a job.

        Raises
        ------
        RequestError
            Another job is running, or an option does not exist.
        """
        studio, folder, stem = self._studio, document.path.parent, document.path.stem
        verified, printed = (folder / f"{stem}{end}" for end in ("-verified", "-print"))
        table, sheet, target = (document.table, str(folder)), studio.shown.sheet, studio.parts.target
        exact = studio.shown.exact_of(document.revision)
        arguments: tuple[Any, ...]
        match request:
            case ask.Simple(type="verify" as kind):
                arguments = (*table, str(verified), sheet)
            case ask.FitRequest(type=kind):
                if target is None:
                    raise RequestError("target: send a file first")
                weights = sheet_weights(document.table, document.layout, sheet, target)
                arguments = (target.surface_of_file, target.name, request.hold, studio.printer, weights)
            case ask.ExportRequest(type=kind):
                arguments = (*table, str(printed), request.settings(studio.printer), exact)
            case ask.Simple(type="report" as kind):
                arguments = (*table, str(folder / f"{stem}.pdf"), studio.printer, exact)
            case ask.Simple(type="animate" | "spread" as kind):
                if exact is None:
                    raise RequestError("this is about the exact shape: wait until it is there")
                file = f"{stem}-release.gif" if kind == "animate" else f"{stem}-spread.png"
                arguments = str(folder / file), exact
            case _:
                raise RequestError("the server does not do that")
        if self._running is not None:
            raise RequestError("wait for the running job, or cancel it")
        number = next(job_numbers)
        # at low priority
        child = Child(PROCESSES[kind], (number, *arguments), 10).listen(self._message, self._died)
        progress = JobProgress(number, "starting", 0, 0, 0.0)
        self._running = RunningJob(kind, document, document.revision, target, child, progress, (verified, printed))

    def cancel(self) -> None:
        """End the running job."""
        if (job := self._end()) is not None:
            self._studio.tabs.tell({"type": "result", "job": job.kind, "cancelled": True})
            self._studio.tell_state()

    def _end(self) -> RunningJob | None:
        job, self._running = self._running, None
        if job is not None:
            job.clear()
        return job

    async def stop(self) -> None:
        """End what is running, but take the result of a fit that has come."""
        if self._taking is not None:
            await self._taking
        self._end()

    def _message(self, child: Child, message: Any) -> None:
        job = self._running
        if job is None or child is not job.child:
            return
        if isinstance(message, JobProgress):
            job.progress = message
        elif isinstance(message, StudioProblem | Settled | Fitted | Written):
            self._running = None
        self._tell(job, message)

    def _died(self, child: Child) -> None:
        job = self._running
        if job is not None and child is job.child:
            self._running = None
            job.clear()
            self._tell(job, StudioProblem(job.progress.job, "ended", f"the {job.kind} ended unexpectedly"))

    def _tell(self, job: RunningJob, message: Any) -> None:
        """Pass on a message of a job. A failure becomes a message of its own, since no caller handles an exception."""
        studio = self._studio
        try:
            self._pass_on(job, message)
        except Exception as error:
            self._fail(job, problem_data(error, None, work=f"a message of the job {job.kind}"))
            studio.tell_state()

    def _pass_on(self, job: RunningJob, message: Any) -> None:
        studio = self._studio
        other = None if job.document is studio.document else job.document.path.stem
        match message:
            case JobProgress():
                studio.tabs.tell({"type": "progress", **job.progress_data})
                return
            case StudioProblem():
                problem = message.data
                self._fail(job, problem if other is None else elsewhere(problem, f"{other}: {message.text}"))
            case Settled() if other is not None:
                text = f"The verification of {other} is done; its files are beside that design."
                self._fail(job, {"type": "note", "text": text})
            case Settled():
                if job.revision == job.document.revision:
                    studio.settling.cancel()
                    studio.shown.show_exact(message, job.revision, studio.engine.last_seq, studio.tabs)
                self._finish(job, message.summary, [Path(name) for name in message.files], ())
            case Fitted():
                self._taking = asyncio.create_task(self._take(job, message))
            case Written():
                files = [Path(message.folder) / name for name in message.files]
                self._finish(job, message.summary, files, message.warnings)
        studio.tell_state()

    def _fail(self, job: RunningJob, why: dict[str, Any]) -> None:
        """Tell pages that a job has no result to be shown, after the message that says why."""
        self._studio.tabs.tell({**why, "job": job.kind} if why["type"] == "problem" else why)
        self._studio.tabs.tell({"type": "result", "job": job.kind, "failed": True})

    def _finish(self, job: RunningJob, summary: dict[str, Any], files: list[Path], warnings: tuple[str, ...]) -> None:
        root = self._studio.folder
        listed = [
            {"name": file.resolve().relative_to(root).as_posix(), "size": file.stat().st_size}
            for file in files
            if file.resolve().is_relative_to(root) and file.is_file()
        ]
        self._studio.tabs.tell(
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
        job = self._running
        return {} if job is None else {job.kind: {"revision": job.revision, **job.progress_data}}

    async def _take(self, job: RunningJob, fitted: Fitted) -> None:
        """Show the fitted design when no request is being worked on: one undo step, and the target in its pose."""
        studio = self._studio
        async with studio.lock:
            document = studio.document
            if document is None or document is not job.document:
                text = "the fit is left out: another design was opened meanwhile"
                return self._fail(job, {"type": "note", "text": text})
            before = document.revision
            try:
                await asyncio.to_thread(document.end_gesture)
                name = document.table.get("name", fitted.table["name"])
                document.apply({**fitted.table, "name": name}, None, "Fit to the target")
                await studio.accept()
                studio.parts.pose(fitted, job.target)
                result = {"revision": document.revision, "summary": plain(fitted.summary)}
                studio.tabs.tell({"type": "result", "job": "fit", **result})
            except Exception as error:  # nobody waits for this task: the page is where it can be seen
                if document.revision != before:
                    document.take_back()
                self._fail(job, problem_data(error, document.layout, work="the result of a fit"))
