"""The engine as the server sees it: always there, replaced when it ends or hangs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from asterism.studio.child import ENGINE, Child
from asterism.studio.messages import (
    Busy,
    Cancel,
    Edit,
    Flip,
    Frame,
    Parts,
    Ready,
    ShapeSummary,
    ShowForm,
    Sign,
    StudioProblem,
    TargetPose,
)


class EngineLink:
    """Sends edits to an engine process, and passes its answers on.

    Attributes
    ----------
    status : `starting`, `computing`, `ready` or `failed`.

    Parameters
    ----------
    receive : called with each message of the engine that belongs to the last edit or an earlier one.
    changed : called when the status has changed.
    target : body of the process; tests put a quick one in its place.
    first : the first engine, if it has been started already.
    keeps_spare : a second engine loads everything and waits, so that a replacement costs no time.
    """

    def __init__(
        self,
        receive: Callable[[Any], None],
        changed: Callable[[], None],
        target: str = ENGINE,
        keeps_spare: bool = True,
        first: Child | None = None,
    ) -> None:
        self._first = first
        self._receive, self._changed, self._target, self._keeps_spare = receive, changed, target, keeps_spare
        self._known: Edit | None = None  # the last one, with the form of its shape, for the next engine
        self._parts: Parts | None = None
        self._deaths = 0
        self._loaded: set[Child] = set()
        self._owes: int | None = None  # seq of the last edit without an answer
        self._search: str | None = None  # the search that was asked for last, if nothing was asked for since
        self._asked = time.monotonic()
        self._spare: Child | None = None
        self.status = "starting"
        self._child = self._start()

    def _start(self) -> Child:
        child, self._first = self._first or Child(self._target), None
        return child.listen(self._message, self._died)

    def edit(self, edit: Edit) -> None:
        """Show a design; the newest edit wins."""
        snapshot = edit.snapshot if edit.is_opened or self._known is None else self._known.snapshot
        self._known = replace(edit, is_dragging=False, snapshot=snapshot)
        self._deaths = 0
        self.ask(edit)

    def ask(self, message: Any) -> None:
        """Send an `Edit` to be shown, `Flip`, `ShowForm` or `FitTarget`."""
        self._search = {Flip: "flip", ShowForm: "form"}.get(type(message))
        self._owes, self._asked = message.seq, time.monotonic()
        self._set("computing" if self._child in self._loaded else "starting")
        self._child.send(message)
        if not isinstance(message, Edit):
            self._changed()  # the search has a name

    def request_parts(self, parts: Parts) -> None:
        """Request these parts in all frames, also in those of an engine that replaces this one."""
        self._parts = parts
        self._child.send(parts)

    @property
    def searching(self) -> str | None:
        """The search for another form that the engine works on: `flip`, `form` or None."""
        return self._search if self._owes is not None else None

    def stop(self) -> None:
        """Break off what the engine computes; the shown shape stays."""
        if self._owes is not None:
            self._child.send(Cancel(self._owes))

    def _set(self, status: str) -> None:
        if status != self.status:
            self.status = status
            self._changed()

    def _message(self, child: Child, message: Any) -> None:
        if isinstance(message, Ready):
            self._loaded.add(child)
        if child is not self._child:
            return
        if isinstance(message, Sign):
            if message.is_stuck and self._owes is not None:
                self._replace("the preview was stuck and was started again")
            return
        if isinstance(message, Ready):
            self._set("computing" if self._owes is not None else "ready")
            self._start_spare()
        if isinstance(message, Frame):
            known = self._known
            if known is not None and message.snapshot is not None and message.seq >= known.seq:
                self._known = replace(known, snapshot=message.snapshot)  # no other design was opened since
        answers = isinstance(message, StudioProblem | ShapeSummary | TargetPose) or (
            isinstance(message, Frame) and message.stage != "linear"
        )
        is_last = answers and self._owes is not None and message.seq >= self._owes
        if is_last:
            self._owes = None
        self._receive(message)
        if is_last and self._owes is None:
            self._set("ready")  # after the answer: pages are never told that an older shape is the last one

    def _start_spare(self) -> None:
        if self._keeps_spare and self._spare is None and self._child in self._loaded:
            self._spare = self._start()

    def watch(self) -> None:
        """Replace an engine that is silent although an answer is due; to be called now and then."""
        silent = time.monotonic() - max(self._child.last_sign, self._asked)
        # longer while it loads: a first start compiles for half a minute on an idle machine
        patience = 5.0 if self._child in self._loaded else 300.0
        if self._owes is not None and silent > patience:
            self._replace(f"the preview gave no sign for {patience:.0f} s and was started again")

    def _died(self, child: Child) -> None:
        if child is self._spare:
            self._spare = None
        elif child is self._child:
            self._replace("the preview ended unexpectedly and was started again")

    def _replace(self, why: str) -> None:
        self._child.kill()
        self._loaded.discard(self._child)
        self._deaths += 1
        owed, self._owes = self._owes, None
        self._child, self._spare = self._spare or self._start(), None
        if self._deaths > 2:  # on one edit: the engine waits for another one
            self._receive(
                StudioProblem(owed or 0, "engine", "the preview cannot compute this design; change it to go on")
            )
            self._set("failed")
            return
        self._receive(Busy(owed or 0, why))
        if self._parts is not None:
            self._child.send(self._parts)
        if self._known is not None:
            self.ask(self._known)
        self._start_spare()

    def close(self) -> None:
        """End the engine and its spare."""
        for child in (self._child, self._spare):
            if child is not None:
                child.close()
