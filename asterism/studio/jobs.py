"""Jobs beside the engine: verification, fit, export, report. One at a time, at low priority, and can be cancelled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

from asterism.studio.child import Child, StartedProcess
from asterism.studio.job_messages import Computed, Fitted, JobProgress, Verified, Written
from asterism.studio.messages import StudioProblem

NICENESS = 10


@dataclass
class RunningJob:
    """A job under way: its number, its kind (`verify`, `fit`, `export`, `report`), its revision and progress."""

    number: int
    kind: str
    revision: int
    child: Child
    progress: JobProgress

    @property
    def progress_data(self) -> dict[str, Any]:
        """The progress as plain data for the page."""
        return {**asdict(self.progress), "job": self.kind}


class Jobs:
    """Runs one job at a time.

    Parameters
    ----------
    tell : called with the job and each of its messages. The last one is `Verified`, `Computed`, `Fitted`,
        `Written` or `StudioProblem`.
    """

    def __init__(self, tell: Callable[[RunningJob, Any], None]) -> None:
        self._tell = tell
        self._count = 0
        self.running: RunningJob | None = None

    def start(self, kind: str, revision: int, target: str, *arguments: Any) -> bool:
        """Start a job in a process of its own; False if another one is running."""
        if self.running is not None:
            return False
        self._count += 1
        child = Child(StartedProcess(target, (self._count, *arguments), NICENESS), self._message, self._died)
        progress = JobProgress(self._count, "starting", 0, 0, 0.0)
        self.running = RunningJob(self._count, kind, revision, child, progress)
        return True

    def cancel(self) -> RunningJob | None:
        """End the running job, and return it."""
        job, self.running = self.running, None
        if job is not None:
            job.child.kill()
        return job

    def _message(self, child: Child, message: Any) -> None:
        job = self.running
        if job is None or child is not job.child:
            return
        if isinstance(message, JobProgress):
            job.progress = message
        elif isinstance(message, StudioProblem | Verified | Computed | Fitted | Written):
            self.running = None
        self._tell(job, message)

    def _died(self, child: Child) -> None:
        job = self.running
        if job is not None and child is job.child:
            self.running = None
            self._tell(job, StudioProblem(job.number, "ended", f"the {job.kind} ended unexpectedly"))

    def close(self) -> None:
        """End what is running."""
        self.cancel()
