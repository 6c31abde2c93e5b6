"""What is computed beside the server: previews by the engine, exact shapes by a process that stays, and their target.

The exact shape of a design at rest follows its preview. The release from the flat print follows; it may end in another
form, which is kept beside the first.
"""

from __future__ import annotations

import asyncio
import itertools
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

from asterism.studio import requests as ask
from asterism.studio.child import Child
from asterism.studio.document import Document
from asterism.studio.engine_link import EngineLink
from asterism.studio.messages import (
    Busy,
    Edit,
    FitTarget,
    Fitted,
    Flip,
    Frame,
    JobProgress,
    Limits,
    Parts,
    Ready,
    Released,
    Rested,
    Settle,
    Settled,
    ShapeSummary,
    ShowForm,
    StudioProblem,
    TargetPose,
)
from asterism.studio.pages import KeptShape, Shown, Tab, Tabs
from asterism.studio.requests import RequestError
from asterism.studio.star_sizes import split
from asterism.studio.target import Target

# An exact shape that is estimated to take longer waits for a click.
MAX_SECONDS = 20.0
# numbers of jobs and exact shapes
job_numbers = itertools.count(1)


class StudioOwner(Protocol):
    """The part of the studio that its helpers use; they stand below it."""

    folder: Path
    document: Document | None
    printer: str
    lock: asyncio.Lock
    shown: Shown
    tabs: Tabs
    engine: EngineRequests
    parts: FrameParts
    settling: Settling

    def tell_state(self) -> None: ...
    def tell_document(self) -> None: ...
    async def accept(self, snapshot: bytes | None = None) -> None: ...


class EngineRequests:
    """Numbers what the engine is asked for, and passes its answers to the pages.

    Attributes
    ----------
    limits : what the law covers; None until the engine has said so.
    last_seq : number of the last question.
    """

    def __init__(self, studio: StudioOwner, make_engine: Callable[..., EngineLink]) -> None:
        self._studio = studio
        self.limits: Limits | None = None
        self.last_seq = 0
        self._first_seq = 0  # of the last question for another shape
        self._revisions: dict[int, int] = {}  # of the document, by question
        self.link = make_engine(self._answer, studio.tell_state)

    def data(self) -> dict[str, Any]:
        """The engine's part of the message `state`."""
        return {"engine": self.link.status, "searching": self.link.searching}

    def forget(self) -> None:
        """Another document is open: answers about the last one are dropped."""
        self._revisions.clear()

    def _new_seq(self) -> int:
        """Number of a new question about the document as it is."""
        self.last_seq += 1
        document = self._studio.document
        # answers to older edits do not come any more
        self._revisions = {seq: one for seq, one in self._revisions.items() if seq > self.last_seq - 200}
        self._revisions[self.last_seq] = -1 if document is None else document.revision
        return self.last_seq

    def show(
        self, document: Document, is_dragging: bool = False, is_opened: bool = False, snapshot: bytes | None = None
    ) -> None:
        """Have the engine compute what the document shows; the arguments are those of `Edit`."""
        self._ask_anew()
        parts, folder = split(document.table), str(document.path.parent)
        self.link.edit(Edit(self._new_seq(), *parts, is_dragging, is_opened, snapshot, folder))

    def search(self, question: type[Flip | ShowForm], *arguments: int) -> None:
        """Have the engine search for the other side, or for another form."""
        self._ask_anew()
        self.ask(question, *arguments)

    def _ask_anew(self) -> None:
        """Another shape is asked for: the exact one under way is that of another design or form."""
        self._studio.settling.cancel()
        self._first_seq = self.last_seq + 1

    def ask(self, question: type[Flip | ShowForm | FitTarget], *arguments: int) -> int:
        """Ask about the document as it is; the number of the question."""
        seq = self._new_seq()
        self.link.ask(question(seq, *arguments))
        return seq

    def _answer(self, message: Any) -> None:
        studio, shown = self._studio, self._studio.shown
        revision = self._revisions.get(getattr(message, "seq", -1), -1)
        is_of_last = revision >= 0 and message.seq >= self._first_seq
        match message:
            case Ready():
                return studio.settling.warm()
            case TargetPose():
                return studio.parts.move(message)
            case Limits():
                self.limits = message
                return studio.tell_document()
            case Frame(form=None) if revision >= 0:
                shown.add_frame(message, revision, studio.tabs)
            case ShapeSummary() if revision >= 0:
                shown.add_summary(message, revision)
            case Frame() if is_of_last:
                shown.add_form(message)
            case Rested() if is_of_last:
                studio.settling.rest(message, revision)
            case StudioProblem(kind="no other side" | "no such form" | "no target" | "search ended") if revision >= 0:
                shown.busy = None  # they do not concern the shown shape
                studio.tabs.tell({**message.data, "revision": revision})
            case StudioProblem() if message.seq >= self.last_seq or message.kind == "engine":
                shown.add_problem(message)
                studio.tabs.tell({**message.data, "revision": revision})
            case Busy():
                shown.busy = message.what
            case _:
                return None
        studio.tell_state()


class FrameParts:
    """Keeps the target surface and whether pages show the sheet without bumps, and has the engine send it.

    Attributes
    ----------
    version : increases with every change of the target or its pose.
    requested : what frames hold now.
    """

    def __init__(self, studio: StudioOwner) -> None:
        self._studio = studio
        self.target: Target | None = None
        self.version = 0
        self.requested = Parts(0)
        self._fits: tuple[int, int] | None = None  # seq of the question, version of the target

    def show_bumps(self, tab: Tab, shown: bool) -> None:
        """A page shows the sheet with or without its bumps."""
        tab.is_smooth = not shown
        self.update()

    def update(self) -> None:
        """Have the engine send what the open pages show."""
        smooth = any(tab.is_smooth for tab in self._studio.tabs)
        if smooth != self.requested.smooth:
            self._request(smooth)

    def _request(self, smooth: bool) -> None:
        surface = None if self.target is None else self.target.surface
        self.requested = Parts(self._studio.engine.last_seq, smooth, surface, self.version)
        self._studio.engine.link.request_parts(self.requested)
        self._studio.settling.show_again()

    def load(self, target: Target) -> None:
        """Show a target that was sent, laid on the shape if there is one."""
        self.set_target(target)
        if self._studio.shown.revision is not None:
            self.fit()

    def set_target(self, target: Target | None) -> None:
        """Show another target, or none."""
        self.target, self.version = target, self.version + 1
        self._request(self.requested.smooth)
        self._studio.tell_state()

    def forget_target(self) -> None:
        """Another design is open: the target was for the one before."""
        if self.target is not None:
            self.set_target(None)

    def place(self, request: ask.TargetRequest) -> None:
        """Do with the target what a page asks for."""
        if self.target is None:
            raise RequestError("target: send a file first")
        if request.do == "remove":
            self.set_target(None)
            return
        if request.unit is not None or request.do == "file":
            self.set_target(self.target.as_in_file(request.unit))
        if request.do == "fit":
            self.fit()

    def fit(self) -> None:
        """Have the engine lay the target on the shape."""
        self._fits = self._studio.engine.ask(FitTarget), self.version

    def move(self, pose: TargetPose) -> None:
        """The engine has laid the target on the shape."""
        if self.target is not None and self._fits == (pose.seq, self.version):
            self.set_target(self.target.moved(pose))

    def pose(self, fitted: Fitted, of: Target | None) -> None:
        """Show the target of a fit in its pose there; a free sheet has its own, so that the target is laid on it."""
        now = self.target
        if now is None or of is None or now.vertices is not of.vertices or now.unit != of.unit:
            return  # another target, or another size of it
        self.set_target(replace(now, rotation=fitted.rotation, shift=fitted.shift, is_fitted=True))
        if not fitted.table.get("pins"):
            self.fit()

    def data(self) -> dict[str, object] | None:
        """The target for the message `state`."""
        return None if self.target is None else {**self.target.data(), "version": self.version}


class Settling:
    """Has the exact shape computed of what has come to rest, and shows it unless something else is asked for meanwhile.

    Attributes
    ----------
    waits_s : seconds that the exact shape would take, if it waits for a click.
    """

    def __init__(self, studio: StudioOwner) -> None:
        self._studio = studio
        self._child: Child | None = None
        self._rested: tuple[Rested, int] | None = None  # with the revision
        self._order: tuple[Settle, int] | None = None  # the last one, with the revision
        self._progress: JobProgress | None = None
        self._begun = 0.0  # monotonic time of the order
        self._settled: Settled | None = None  # the answers to the order
        self._released: Released | None = None
        self._shapes: dict[str, KeptShape] = {}  # of both exact forms, where they differ
        self._shows_release = False
        self.waits_s: float | None = None

    def warm(self) -> None:
        """Start the process, so that it has loaded everything when it is needed."""
        if self._child is None:
            self._child = Child("asterism.studio.job_processes:run_settling", (), 5).listen(self._message, self._died)

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
            has_release,
        )
        self._order, self._progress, self.waits_s = (order, revision), None, None
        self._settled = self._released = None
        self._begun = time.monotonic()
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
        """Seconds that the exact shape has taken, and that it takes in all, estimated, for the message `state`.

        None if none is under way, or it is shown already: it is computed once more while it is shown where pages ask
        for it with other parts, such as a target.
        """
        if not self._is_at_work or self._is_shown or self._rested is None:
            return None
        return {"seconds": time.monotonic() - self._begun, "about_s": self._rested[0].seconds}

    @property
    def release(self) -> dict[str, Any] | None:
        """How far the release is, or where it ended, for the message `state`."""
        released = self._released
        if not self._is_shown or self._order is None or not self._order[0].release:
            return None
        if released is None:
            done, of = (0, 0) if self._progress is None else (self._progress.done, self._progress.of)
            return {"progress": {"done": done, "of": of}}
        return {
            "is_same": released.is_same,
            "energy_percent": released.energy_percent,
            "apart_percent": released.apart_percent,
            "is_shown": self._shows_release,
            "shapes": {name: shape.number for name, shape in self._shapes.items()},
        }

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
                    self._shapes = {name: studio.shown.keep(form.frame) for name, form in forms.items()}
                if self._shows_release and message.other is not None:
                    self._show(message.other)
            case StudioProblem() if self._settled is not None:
                self._forgo_release()
            case StudioProblem():
                revision, self._order = self._order[1], None
                studio.tabs.tell({**message.data, "revision": revision})
        studio.tell_state()

    def _forgo_release(self) -> None:
        """The release has failed, or its process is gone; the exact shape stays."""
        assert self._order is not None
        if self._released is None:
            order, revision = self._order
            self._order, self._shows_release = (replace(order, release=False), revision), False

    def _died(self, child: Child) -> None:
        studio, self._child = self._studio, None
        if self._order is not None and not self._is_at_work:
            self._forgo_release()
            studio.tell_state()
            return
        had, self._order = self._order, None
        if had is not None:
            text = "the exact model ended unexpectedly; an edit starts it again"
            studio.tabs.tell({**StudioProblem(0, "engine", text).data, "revision": had[1]})
            studio.tell_state()
