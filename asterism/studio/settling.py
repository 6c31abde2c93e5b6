"""Settling: the exact shape of a design at rest follows its preview, from one process that stays.

The release from the flat print follows; it may end in another form, which is kept beside the first.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

from asterism.studio.child import Child, StartedProcess
from asterism.studio.engine_requests import StudioOwner
from asterism.studio.messages import JobProgress, Released, Rested, Settle, Settled, StudioProblem
from asterism.studio.page_data import engine_problem_data
from asterism.studio.shown_shape import KeptShape

PROCESS = "asterism.studio.settling_process:run_settling"
# An exact shape that is estimated to take longer waits for a click.
MAX_SECONDS = 20.0
NICENESS = 5
# numbers of jobs and exact shapes: their meshes must not share one
job_numbers = itertools.count(1)


class Settling:
    """Has the exact shape computed of what has come to rest, and shows it unless something else is asked for meanwhile.

    Attributes
    ----------
    waits_s : seconds that the exact shape would take, if it waits for a click.
    """

    def __init__(self, studio: StudioOwner, process: str = PROCESS) -> None:
        self._studio, self._process = studio, process
        self._child: Child | None = None
        self._rested: tuple[Rested, int] | None = None  # with the revision
        self._order: tuple[Settle, int] | None = None  # the last one, with the revision
        self._progress: JobProgress | None = None
        self._settled: Settled | None = None  # the answers to the order
        self._released: Released | None = None
        self._shapes: dict[str, KeptShape] = {}  # of both exact forms, where they differ
        self._shows_release = False
        self.waits_s: float | None = None

    def warm(self) -> None:
        """Start the process, so that it has loaded everything when it is needed."""
        if self._child is None:
            self._child = Child(StartedProcess(self._process, (), NICENESS), self._message, self._died)

    def rest(self, rested: Rested, revision: int) -> None:
        """A design is at rest; what takes long waits for `begin`."""
        self.cancel()
        self._rested = rested, revision
        if rested.seconds <= MAX_SECONDS:
            self._begin()
        else:
            self.waits_s = rested.seconds

    def begin(self) -> None:
        """Compute the exact shape of what is at rest; does nothing if it is shown or under way."""
        if not self._is_at_work and not self._is_shown:
            self._begin()

    def _begin(self) -> None:
        studio, document = self._studio, self._studio.document
        if self._rested is None or document is None:
            return
        self.warm()
        assert self._child is not None
        rested, revision = self._rested
        # what drawn rods and large sheets show is a release, or took long enough
        has_release = rested.shape is not None and rested.seconds <= MAX_SECONDS
        order = Settle(
            next(job_numbers),
            document.table,
            str(document.path.parent),
            rested.shape,
            studio.shown.sheet,
            studio.parts.requested,
            next(job_numbers) if has_release else None,
        )
        self._order, self._progress, self.waits_s = (order, revision), None, None
        self._settled = self._released = None
        self._child.send(order)

    @property
    def _is_at_work(self) -> bool:
        """Whether an exact shape is under way; its release does not count."""
        return self._order is not None and self._settled is None

    @property
    def _is_shown(self) -> bool:
        document = self._studio.document
        return document is not None and self._studio.shown.exact_of(document.revision) is not None

    def show_again(self) -> None:
        """Another target, or the sheet without its bumps: show the exact shape with that."""
        if self._is_shown or self._is_at_work:
            self._begin()

    def show_form(self, released: bool) -> None:
        """Show the exact shape that the release led to, or the one that followed the preview."""
        other = None if self._released is None else self._released.other
        form = other if released else self._settled
        if form is not None and self._is_shown:
            self._shows_release = released
            self._show(form)

    def stop(self) -> None:
        """The person breaks it off; a click begins it again."""
        rested, had = self._rested, self._is_at_work
        self.cancel()
        if rested is not None and had:
            self._rested, self.waits_s = rested, rested[0].seconds

    def cancel(self) -> None:
        """Something else is asked for: the exact shape under way is not wanted."""
        if self._order is not None and self._child is not None:
            self._child.send(None)
        self._order = self._rested = self._progress = self.waits_s = self._settled = self._released = None
        self._shows_release, self._shapes = False, {}

    def close(self) -> None:
        """End the process."""
        if self._child is not None:
            self._child.close()

    def data(self) -> dict[str, Any] | None:
        """How far the exact shape is, for the message `state`; None if none is under way."""
        return self._progress_data if self._is_at_work else None

    @property
    def release(self) -> dict[str, Any] | None:
        """How far the release is, or where it ended, for the message `state`."""
        released = self._released
        if not self._is_shown or self._order is None or self._order[0].release_mesh is None:
            return None
        if released is None:
            return {"progress": self._progress_data}
        return {
            "is_same": released.is_same,
            "energy_percent": released.energy_percent,
            "apart_percent": released.apart_percent,
            "is_shown": self._shows_release,
            "shapes": {name: shape.number for name, shape in self._shapes.items()},
        }

    @property
    def _progress_data(self) -> dict[str, Any]:
        progress = self._progress
        return {"done": 0, "of": 0} if progress is None else {"done": progress.done, "of": progress.of}

    def _show(self, form: Settled) -> None:
        studio = self._studio
        assert self._order is not None and self._rested is not None
        studio.shown.show_exact(form, self._order[1], self._rested[0].seq, studio.tabs)

    def _message(self, child: Child, message: Any) -> None:
        studio = self._studio
        number = message.seq if isinstance(message, StudioProblem) else message.job
        if self._order is None or number != self._order[0].job:
            return  # about a design that has changed since
        match message:
            case JobProgress():
                self._progress = message
            case Settled():
                self._settled, self._progress = message, None
                if not self._shows_release:  # else the release follows at once, with other parts than before
                    self._show(message)
            case Released():
                self._released = message
                if self._settled is not None and message.other is not None:
                    forms = {"preview": self._settled, "released": message.other}
                    self._shapes = {name: studio.shown.keep_settled(form) for name, form in forms.items()}
                if self._shows_release and message.other is not None:
                    self._show(message.other)
            case StudioProblem() if self._settled is not None:
                self._forgo_release()
            case StudioProblem():
                revision, self._order = self._order[1], None
                studio.tell({**engine_problem_data(message), "revision": revision})
        studio.tell_state()

    def _forgo_release(self) -> None:
        """The release has failed, or its process is gone; the exact shape stays."""
        assert self._order is not None
        if self._released is None:
            order, revision = self._order
            self._order, self._shows_release = (replace(order, release_mesh=None), revision), False

    def _died(self, child: Child) -> None:
        studio, self._child = self._studio, None
        if self._order is not None and not self._is_at_work:
            self._forgo_release()
            studio.tell_state()
            return
        had, self._order = self._order, None
        if had is not None:
            text = "the exact model ended unexpectedly; an edit starts it again"
            studio.tell({**engine_problem_data(StudioProblem(0, "engine", text)), "revision": had[1]})
            studio.tell_state()
