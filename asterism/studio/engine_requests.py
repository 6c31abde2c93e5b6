"""What the studio has the engine compute, and the engine's answers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from asterism.studio import requests as ask
from asterism.studio.document import Document
from asterism.studio.engine_link import EngineLink
from asterism.studio.engine_orders import Edit, FitTarget, Flip, ShowForm
from asterism.studio.messages import ANSWERS, Busy, Frame, Limits, ShapeSummary, ShownMesh, StudioProblem, TargetPose
from asterism.studio.page_data import engine_problem_data
from asterism.studio.painted import split
from asterism.studio.shown import Shown
from asterism.studio.tab import Tabs

# Edits whose answers may still come.
MAX_OPEN_EDITS = 200


class PoseTaker(Protocol):
    """What takes the answer to `FitTarget`."""

    def move(self, pose: TargetPose) -> None: ...


class ShapeOwner(Protocol):
    """The part of the studio that `EngineRequests` uses."""

    document: Document | None
    shown: Shown
    tabs: Tabs

    @property
    def parts(self) -> PoseTaker: ...
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

    def __init__(self, studio: ShapeOwner, make_engine: Callable[..., EngineLink]) -> None:
        self._studio = studio
        self.limits: Limits | None = None
        self.last_seq = 0
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
        self._revisions = {seq: one for seq, one in self._revisions.items() if seq > self.last_seq - MAX_OPEN_EDITS}
        self._revisions[self.last_seq] = -1 if document is None else document.revision
        return self.last_seq

    def show(
        self, document: Document, is_dragging: bool = False, is_opened: bool = False, snapshot: bytes | None = None
    ) -> None:
        """Have the engine compute what the document shows; the arguments are those of `Edit`."""
        base, sites, sizes, removed = split(document.table)
        design = None if base == self._sent_base else base
        self._sent_base = base
        folder = str(document.path.parent)
        self.link.edit(
            Edit(self._new_seq(), design, sites, sizes, removed, is_dragging, is_opened, snapshot, folder),
        )

    def search(self, request: ask.FlipRequest | ask.FormRequest) -> None:
        """Have the engine search for the other side, or for another form."""
        seq = self._new_seq()
        self.link.ask(Flip(seq) if isinstance(request, ask.FlipRequest) else ShowForm(seq, request.index))

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
            case Frame() if revision >= 0:
                shown.add_frame(message, revision, studio.tabs)
                studio.tell_state()
            case ShapeSummary() if revision >= 0:
                shown.add_summary(message, revision)
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
