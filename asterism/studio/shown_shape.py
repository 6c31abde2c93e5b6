"""The shape that the page shows: meshes, the last frame, numbers and warnings."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from asterism.equilibrium.arrays import Array
from asterism.pattern.design.files import plain
from asterism.studio import frames
from asterism.studio.frames import frame_parts, mesh_bytes
from asterism.studio.messages import Frame, ShapeSummary, ShownMesh, StudioProblem, Verified
from asterism.studio.page_data import engine_problem_data
from asterism.studio.tab import Tab


class Shown:
    """Collects what the engine sends, and passes it to the tabs.

    Attributes
    ----------
    meshes : packed meshes by number, the newest last.
    numbers : of the last shape, for the message `state`.
    snapshots : forms by the document's revision, to come back to by undo.
    """

    def __init__(self) -> None:
        self.meshes: dict[int, bytes] = {}
        self.snapshots: dict[int, bytes] = {}
        self.clear()

    def clear(self) -> None:
        """Forget the shape: another document is open."""
        self.numbers: dict[str, Any] = {}
        self.warnings: list[dict[str, Any]] = []
        self.forms: list[dict[str, Any]] = []
        self.problem: dict[str, Any] | None = None
        self.busy: str | None = None
        self.stage: str | None = None
        self.revision: int | None = None
        self.summary_revision: int | None = None
        self._last: tuple[int, dict[str, Any], dict[str, Any]] | None = None
        self.snapshots.clear()

    def add_mesh(self, mesh: ShownMesh) -> None:
        """Keep a mesh for the tabs."""
        self.meshes[mesh.mesh] = mesh_bytes(mesh)
        for old in list(self.meshes)[:-6]:
            del self.meshes[old]

    def add_frame(self, frame: Frame, revision: int, tabs: Iterable[Tab]) -> None:
        """Show a shape in all tabs."""
        if not frame.is_again:
            self.busy, self.problem = None, None
        self.stage, self.revision = frame.stage, revision
        self.numbers = {**self.numbers, "height_mm": float(frame.height_mm), "is_minimum": bool(frame.is_minimum)}
        if frame.snapshot is not None:
            self.snapshots[revision] = frame.snapshot
            for old in list(self.snapshots)[:-50]:
                del self.snapshots[old]
        header, arrays = frame_parts(frame)
        self._last = (frame.mesh, {"revision": revision, **header}, arrays)
        for tab in tabs:
            tab.show(*self._last)

    @property
    def sheet(self) -> tuple[Array, Array] | None:
        """Printed (V, 2) and shown (V, 3) places of the last sheet, mm; None without one."""
        if self._last is None or (packed := self.meshes.get(self._last[0])) is None:
            return None
        return frames.unpack(packed)[2]["printed"], self._last[2]["positions"]

    def add_summary(self, summary: ShapeSummary, revision: int) -> None:
        """Numbers, warnings and forms of a shape."""
        self.numbers = plain({**self.numbers, **summary.numbers})
        self.warnings = [asdict(notice) for notice in summary.warnings]
        self.forms = [asdict(form) for form in summary.forms]
        self.summary_revision = revision

    def add_problem(self, problem: StudioProblem) -> dict[str, Any]:
        """An edit without a shape: the last good one stays. Returns the problem's data."""
        data = engine_problem_data(problem)
        self.problem, self.busy = data, None
        return data

    def show_verified(self, verified: Verified, revision: int, tabs: Iterable[Tab]) -> None:
        """Show both shapes of a verification."""
        self.add_mesh(verified.mesh)
        arrays = {"exact": verified.exact, "preview": verified.preview, "distance": verified.distance}
        for tab in tabs:
            tab.show(verified.mesh.mesh, {"revision": revision}, arrays, frames.COMPARISON)

    def greet(self, tab: Tab) -> None:
        """Show the last shape in a tab that has just been opened."""
        if self._last is not None:
            tab.show(*self._last)

    def state(self) -> dict[str, Any]:
        """The shape's part of the message `state`."""
        return {
            "revision": self.revision,
            "stage": self.stage,
            "numbers": self.numbers,
            "summary_revision": self.summary_revision,
            "warnings": self.warnings,
            "forms": self.forms,
            "problem": self.problem,
            "busy": self.busy,
        }
