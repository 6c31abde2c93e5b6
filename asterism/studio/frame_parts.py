"""What pages show beside the shape: the sheet without bumps, and the target surface."""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

from asterism.studio import requests as ask
from asterism.studio.engine_orders import Parts
from asterism.studio.engine_requests import EngineRequests
from asterism.studio.job_messages import Fitted
from asterism.studio.messages import TargetPose
from asterism.studio.request import RequestError
from asterism.studio.shown import Shown
from asterism.studio.tab import Tab, Tabs
from asterism.studio.target import Target


class PartsOwner(Protocol):
    """The part of the studio that `FrameParts` uses."""

    shown: Shown
    tabs: Tabs
    engine: EngineRequests

    def tell_state(self) -> None: ...


class FrameParts:
    """Keeps the target and what the pages show, and has the engine send it.

    Attributes
    ----------
    target : None without one.
    version : increases with every change of the target or its pose.
    """

    def __init__(self, studio: PartsOwner) -> None:
        self._studio = studio
        self.target: Target | None = None
        self.version = 0
        self._requested = Parts(0)
        self._fits: tuple[int, int] | None = None  # seq of the question, version of the target

    def show_bumps(self, tab: Tab, shown: bool) -> None:
        """A page shows the sheet with or without its bumps."""
        tab.is_smooth = not shown
        self.update()

    def update(self) -> None:
        """Have the engine send what the open pages show."""
        smooth = any(tab.is_smooth for tab in self._studio.tabs)
        if smooth != self._requested.smooth:
            self._request(smooth)

    def _request(self, smooth: bool) -> None:
        surface = None if self.target is None else self.target.surface
        self._requested = Parts(self._studio.engine.last_seq, smooth, surface, self.version)
        self._studio.engine.link.request_parts(self._requested)

    def load(self, target: Target) -> None:
        """Show a target that was sent, laid on the shape if there is one."""
        self.set_target(target)
        if self._studio.shown.revision is not None:
            self.fit()

    def set_target(self, target: Target | None) -> None:
        """Show another target, or none."""
        self.target, self.version = target, self.version + 1
        self._request(self._requested.smooth)
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

    def pose(self, fitted: Fitted, version: int) -> None:
        """Show the target of a fit in its pose there; a free sheet has its own, so that the target is laid on it."""
        if self.target is None or self.version != version:
            return  # another target, or moved meanwhile
        self.set_target(replace(self.target, rotation=fitted.rotation, shift=fitted.shift, is_fitted=True))
        if not fitted.table.get("pins"):
            self.fit()

    def data(self) -> dict[str, object] | None:
        """The target for the message `state`."""
        return None if self.target is None else {**self.target.data(), "version": self.version}
