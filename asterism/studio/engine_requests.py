"""What the studio has the engine compute, the engine's answers, and what pages show beside the shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

from asterism.studio import requests as ask
from asterism.studio.document import Document
from asterism.studio.engine_link import EngineLink
from asterism.studio.messages import (
    ANSWERS,
    Busy,
    Edit,
    FitTarget,
    Fitted,
    Flip,
    FormShape,
    Frame,
    Limits,
    Parts,
    Ready,
    Rested,
    ShapeSummary,
    ShowForm,
    ShownMesh,
    StudioProblem,
    TargetPose,
)
from asterism.studio.page_data import engine_problem_data
from asterism.studio.requests import RequestError
from asterism.studio.shown_shape import Shown
from asterism.studio.star_sizes import split
from asterism.studio.tab import Tab, Tabs
from asterism.studio.target import Target


class ExactShapes(Protocol):
    """What has the exact shapes computed, see `asterism.studio.settling`; it stands above."""

    def warm(self) -> None: ...
    def rest(self, rested: Rested, revision: int) -> None: ...
    def cancel(self) -> None: ...
    def show_again(self) -> None: ...


class StudioOwner(Protocol):
    """The part of the studio that its helpers use; they stand below it."""

    document: Document | None
    shown: Shown
    tabs: Tabs
    engine: EngineRequests
    parts: FrameParts

    @property
    def settling(self) -> ExactShapes: ...

    def tell(self, message: dict[str, Any]) -> None: ...
    def tell_state(self) -> None: ...
    def tell_document(self) -> None: ...


class EngineRequests:
    """Numbers what the engine is asked for, and passes its answers to the pages.

    Parameters
    ----------
    studio : whose document is computed.
    make_engine : makes the link to the engine.

    Attributes
    ----------
    link : to the engine.
    limits : what the law covers; None until the engine has said so.
    last_seq : number of the last question.
    """

    def __init__(self, studio: StudioOwner, make_engine: Callable[..., EngineLink]) -> None:
        self._studio = studio
        self.limits: Limits | None = None
        self.last_seq = 0
        self._first_seq = 0  # of the last question for another shape
        self._revisions: dict[int, int] = {}  # of the document, by question
        self._sent_base: dict[str, Any] | None = None
        self.link = make_engine(self._answer, studio.tell_state)

    def data(self) -> dict[str, Any]:
        """The engine's part of the message `state`."""
        return {"engine": self.link.status, "searching": self.link.searching}

    def forget(self) -> None:
        """Another document is open: answers about the last one are dropped."""
        self._revisions.clear()
        self._sent_base = None

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
        base, sites, sizes, removed = split(document.table)
        design = None if base == self._sent_base else base
        self._sent_base = base
        folder = str(document.path.parent)
        self.link.edit(
            Edit(self._new_seq(), design, sites, sizes, removed, is_dragging, is_opened, snapshot, folder),
        )

    def search(self, request: ask.Simple | ask.FormRequest) -> None:
        """Have the engine search for the other side, or for another form."""
        self._ask_anew()
        seq = self._new_seq()
        self.link.ask(ShowForm(seq, request.index) if isinstance(request, ask.FormRequest) else Flip(seq))

    def _ask_anew(self) -> None:
        """Another shape is asked for: the exact one under way is that of another design or form."""
        self._studio.settling.cancel()
        self._first_seq = self.last_seq + 1

    def fit_target(self) -> int:
        """Have the engine lay the target on the shape; return the number of the question."""
        seq = self._new_seq()
        self.link.ask(FitTarget(seq))
        return seq

    def _answer(self, message: Any) -> None:
        studio, shown = self._studio, self._studio.shown
        revision = self._revisions.get(getattr(message, "seq", -1), -1)
        match message:
            case ShownMesh():
                shown.add_mesh(message)
            case Ready():
                studio.settling.warm()
            case Frame() if revision >= 0:
                shown.add_frame(message, revision, studio.tabs)
                studio.tell_state()
            case ShapeSummary() if revision >= 0:
                shown.add_summary(message, revision)
                studio.tell_state()
            case FormShape() if revision >= 0 and message.seq >= self._first_seq:
                shown.add_form_shape(message)
                studio.tell_state()
            case Rested() if revision >= 0 and message.seq >= self._first_seq:
                studio.settling.rest(message, revision)
                studio.tell_state()
            case TargetPose():
                studio.parts.move(message)
            case Limits():
                self.limits = message
                studio.tell_document()
            case StudioProblem() if message.kind in ANSWERS and revision >= 0:
                shown.busy = None
                studio.tell({**engine_problem_data(message), "revision": revision})
                studio.tell_state()
            case StudioProblem() if message.seq >= self.last_seq or message.kind == "engine":
                data = shown.add_problem(message)
                studio.tell({**data, "revision": revision})
                studio.tell_state()
            case Busy():
                shown.busy = message.what
                studio.tell_state()


class FrameParts:
    """Keeps the target surface and whether pages show the sheet without bumps, and has the engine send it.

    Attributes
    ----------
    target : None without one.
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
        self._fits = self._studio.engine.fit_target(), self.version

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
