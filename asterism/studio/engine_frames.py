"""Frames of the engine's shapes: on a coarse and a fine mesh, and beside the target surface."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.compare.nearest import NearestOnSurface
from asterism.measure.compare.registration import register
from asterism.measure.compare.scan import MAX_SCAN_POINTS, surface_samples
from asterism.pattern.design.design import Design
from asterism.previews.session import Preview
from asterism.previews.solve import EDIT_START
from asterism.studio.messages import Frame, Parts, ShownMesh, StudioProblem, Surface, TargetDistance, TargetPose
from asterism.studio.sheet_view import SheetView

EQUILIBRIUM = "equilibrium"


class EngineFrames:
    """Makes the frames of one preview after another.

    Parameters
    ----------
    send : passes a message on; meshes are sent before the first frame on them.
    """

    def __init__(self, send: Callable[[Any], None]) -> None:
        self._send = send
        self._coarse: SheetView | None = None
        self._fine: SheetView | None = None
        self._last_view: SheetView | None = None
        self._shown_seq, self._shown_stage = 0, ""
        self._parts = Parts(0)
        self._target: TargetComparison | None = None
        self._meshes = 0

    def coarse(self, preview: Preview, seq: int, stage: str, x: Floats | None, is_dragging: bool) -> Frame:
        """A stage on the coarse mesh. The distance to the target waits until the pointer is up."""
        view = self._coarse = self._view(preview, self._coarse, is_fine=False)
        if stage == EQUILIBRIUM and preview.equilibrium.guess != EDIT_START:
            view.stand_up(preview, x)
        return self._frame(view, preview, seq, stage, x, is_measured=not is_dragging and stage != "linear")

    def prepare_fine(self, preview: Preview) -> None:
        """Make the fine mesh, and send it."""
        self._fine = self._view(preview, self._fine, is_fine=True)

    def fine(self, preview: Preview, seq: int) -> Frame:
        """The equilibrium on the fine mesh that was prepared, in the pose of the coarse one."""
        view = self._fine
        assert view is not None
        if self._coarse is not None:
            view.rotation = self._coarse.rotation
        return self._frame(view, preview, seq, EQUILIBRIUM, None, is_measured=True)

    def form(self, preview: Preview, seq: int, x: Floats) -> Frame:
        """Another form of the sheet, with positions x (N, 3) of the shell's dofs, on the coarse mesh."""
        view = self._coarse = self._view(preview, self._coarse, is_fine=False)
        rotation = view.rotation
        view.stand_up(preview, x)
        frame = view.frame(preview, seq, EQUILIBRIUM, x, self._parts.smooth)
        view.rotation = rotation
        return frame

    def send_flat(
        self, messages: Callable[[Design, int, int], tuple[ShownMesh, Frame]], design: Design, seq: int
    ) -> None:
        """Send a flat sheet, that of `blank_messages` or of `printed_messages`."""
        self._meshes += 1
        for message in messages(design, self._meshes, seq):
            self._send(message)

    def send_again(self, parts: Parts, preview: Preview | None, is_dragging: bool) -> None:
        """Send the last equilibrium with other parts; frames from now on have them too."""
        if parts.version != self._parts.version:
            self._target = None if parts.target is None else TargetComparison(parts.target, parts.version)
        self._parts = parts
        view = self._last_view
        if preview is not None and view is not None and view.shows(preview) and self._shown_stage == EQUILIBRIUM:
            frame = self._frame(view, preview, self._shown_seq, EQUILIBRIUM, None, is_measured=not is_dragging)
            self._send(replace(frame, seconds=preview.seconds, is_again=True))

    def send_pose(self, preview: Preview | None, seq: int) -> None:
        """Send the motion that lays the target on the last shape."""
        view = self._last_view
        if preview is None or view is None or self._target is None or not view.shows(preview):
            self._send(StudioProblem(seq, "no target", "there is no target or no shape to lay it on"))
            return
        positions = view.frame(preview, seq, EQUILIBRIUM).positions
        self._send(self._target.pose(seq, positions, view.triangles))

    def _frame(
        self, view: SheetView, preview: Preview, seq: int, stage: str, x: Floats | None, is_measured: bool
    ) -> Frame:
        self._last_view, self._shown_seq, self._shown_stage = view, seq, stage
        frame = view.frame(preview, seq, stage, x, self._parts.smooth)
        if self._target is None or not is_measured:
            return frame
        return replace(frame, target=self._target.distance(frame.positions, view.weights))

    def _view(self, preview: Preview, view: SheetView | None, is_fine: bool) -> SheetView:
        """A view of the preview's sheet. Its mesh is sent before the first frame, and again with other arms."""
        if view is None or not view.shows(preview):
            view = SheetView(preview, is_fine)
        layout = preview.sheet.layout
        if not view.has_arms_of(layout):
            self._meshes += 1
            self._send(view.numbered(self._meshes, layout))
        return view


class TargetComparison:
    """Compares sheets with one target.

    Parameters
    ----------
    target : in the pose that is shown.
    version : of this target and pose.
    """

    def __init__(self, target: Surface, version: int) -> None:
        self._version = version
        self._vertices = np.asarray(target.vertices, dtype=float)
        self._triangles = np.asarray(target.triangles, dtype=np.int64)
        self._nearest = NearestOnSurface(self._vertices, self._triangles)

    def distance(self, positions: Floats, weights: Floats) -> TargetDistance:
        """Distances of places (V, 3) mm of a sheet; each stands for a share (V,) of the sheet."""
        away = np.abs(self._nearest(np.asarray(positions, dtype=float)).distance)
        rms = float(np.sqrt(weights @ away**2 / weights.sum()))
        return TargetDistance(away.astype(np.float32), rms, float(away.max()), self._version)

    def pose(self, seq: int, positions: Floats, triangles: Ints) -> TargetPose:
        """The motion that lays the target on a sheet with vertices (V, 3) mm and triangles (T, 3)."""
        samples, _ = surface_samples(self._vertices, self._triangles, MAX_SCAN_POINTS, np.random.default_rng(0))
        best = register(samples, np.asarray(positions, dtype=float), np.asarray(triangles, dtype=np.int64))[0]
        return TargetPose(seq, best.rotation, best.shift)
