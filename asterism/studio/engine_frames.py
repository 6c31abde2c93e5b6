"""Frames of the engine's shapes: on a coarse and a fine mesh that edits keep, and beside the target surface."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Array, Floats, Ints
from asterism.measure.registration import register
from asterism.measure.scan import MAX_SCAN_POINTS, surface_samples
from asterism.pattern.geometry.normals import sum_at_vertices, triangle_normals
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.session import Preview
from asterism.previews.solve import EDIT_START
from asterism.shape.surface import NearestOnSurface, upright_rotation
from asterism.studio.messages import Frame, Parts, Surface, TargetPose
from asterism.studio.sheet_frames import SheetMarks, smooth_arrays

EQUILIBRIUM = "equilibrium"


class EngineFrames:
    """Makes the frames of one preview after another."""

    def __init__(self) -> None:
        self._coarse: SheetView | None = None
        self._fine: SheetView | None = None
        self._last: tuple[SheetView, Frame] | None = None
        self._parts = Parts(0)
        self._target: TargetComparison | None = None

    def coarse(self, preview: Preview, seq: int, stage: str, x: Floats | None, is_dragging: bool) -> Frame:
        """A stage on the coarse mesh. The distance to the target waits until the pointer is up."""
        view = self._coarse = self._view(preview, self._coarse, is_fine=False)
        if stage == EQUILIBRIUM and preview.equilibrium.guess != EDIT_START:
            view.stand_up(preview, x)
        return self._frame(view, preview, seq, stage, x, is_measured=not is_dragging and stage != "linear")

    def prepare_fine(self, preview: Preview) -> None:
        """Make the fine mesh."""
        self._fine = self._view(preview, self._fine, is_fine=True)

    def fine(self, preview: Preview, seq: int) -> Frame:
        """The equilibrium on the fine mesh that was prepared, in the pose of the coarse one."""
        view = self._fine
        assert view is not None
        if self._coarse is not None:
            view.rotation = self._coarse.rotation
        return self._frame(view, preview, seq, EQUILIBRIUM, None, is_measured=True)

    def form(self, preview: Preview, seq: int, index: int, x: Floats) -> Frame:
        """Another form of the sheet, with positions x (N, 3) of the shell's dofs, on the coarse mesh."""
        view = self._coarse = self._view(preview, self._coarse, is_fine=False)
        rotation = view.rotation
        view.stand_up(preview, x)
        frame = view.frame(preview, seq, EQUILIBRIUM, x, self._parts.smooth)
        view.rotation = rotation
        return replace(frame, form=index)

    def set_parts(self, parts: Parts) -> None:
        """What frames from now on hold besides the shape."""
        if parts.version != self._parts.version:
            self._target = None if parts.target is None else TargetComparison(parts.target, parts.version)
        self._parts = parts

    def again(self, preview: Preview | None, is_dragging: bool) -> Frame | None:
        """The last equilibrium with the parts that are asked for now; None without one."""
        if preview is None or self._last is None:
            return None
        view, last = self._last
        if last.stage != EQUILIBRIUM or not view.shows(preview):
            return None
        frame = self._frame(view, preview, last.seq, EQUILIBRIUM, None, is_measured=not is_dragging)
        return replace(frame, is_again=True)

    def pose(self, seq: int) -> TargetPose | None:
        """The motion that lays the target on the last frame; None without either."""
        if self._last is None or self._target is None:
            return None
        view, frame = self._last
        return self._target.pose(seq, frame.arrays["positions"], view.triangles)

    def _frame(
        self, view: SheetView, preview: Preview, seq: int, stage: str, x: Floats | None, is_measured: bool
    ) -> Frame:
        frame = view.frame(preview, seq, stage, x, self._parts.smooth)
        if self._target is not None and is_measured:
            frame = self._target.measured(frame, view.weights)
        self._last = view, frame
        return frame

    def _view(self, preview: Preview, view: SheetView | None, is_fine: bool) -> SheetView:
        return view if view is not None and view.shows(preview) else SheetView(preview, is_fine)


class SheetView:
    """The shown mesh of a print, and where the stages of a preview take it.

    Parameters
    ----------
    is_fine : with the edges for a sheet at rest.

    Attributes
    ----------
    rotation : (3, 3) from the pose of the shell to that shown.
    """

    def __init__(self, preview: Preview, is_fine: bool) -> None:
        self._arm_site: Ints = np.empty(0, dtype=np.int64)
        self._mesh_arrays: dict[str, Array] = {}
        layout, design = preview.sheet.layout, preview.design
        spacings = 1 / 12 if is_fine else 1 / 6  # edges of the triangles
        shortest = float(np.sqrt(layout.area_mm2 / (np.sqrt(0.75) * 30_000)))
        edge = max(spacings * layout.spacing_mm, shortest)
        mesh = mesh_layout(layout, edge, design.mesh.kind, design.mesh.seed, draft=True)
        self.printed, self.triangles = mesh.points, mesh.triangles
        self._print = layout.edges, design.lattice
        self._follow(preview)

    def _follow(self, preview: Preview) -> None:
        """See the sheet of a preview that has the same edges and lattice."""
        # previews of one print share its space, but a lens shows the preview that made it
        self._preview, self._space = preview, preview.sheet.space
        self._lens = preview.lens(self.printed)
        self._marks = SheetMarks(self.printed, self.triangles)
        self.rotation = np.eye(3)

    def shows(self, preview: Preview) -> bool:
        """Whether the mesh is one of the preview's sheet; frames are then of this preview."""
        edges, lattice = self._print
        if preview is self._preview and preview.sheet.space is self._space:
            return True
        if lattice != preview.design.lattice or not edges.equals(preview.sheet.layout.edges):
            return False
        self._follow(preview)
        return True

    def stand_up(self, preview: Preview, x: Floats | None = None) -> None:
        """Choose the pose of a free sheet anew: principal axes along x, y and z. Later stages keep it."""
        self.rotation = np.eye(3)
        if preview.sheet.layout.pins:
            return
        positions = self._lens(x).bumpy
        self.rotation = upright_rotation(
            self.printed, positions, self.weights, triangle_normals(positions, self.triangles).sum(axis=0)
        )

    def frame(self, preview: Preview, seq: int, stage: str, x: Floats | None = None, has_smooth: bool = False) -> Frame:
        """A stage with positions x (N, 3) of the shell's dofs; by default what the preview shows.

        With `has_smooth`, the frame also holds the sheet without its bumps.
        """
        layout, fabric = preview.sheet.layout, preview.design.fabric
        arm_site = self._marks.stations(layout).site
        if not self._mesh_arrays or not np.array_equal(arm_site, self._arm_site):
            self._arm_site = arm_site
            self._mesh_arrays = self._marks.mesh_arrays(layout)
        places = self._lens(x)
        positions, smooth = places.bumpy, places.smooth if has_smooth else None
        if not layout.pins:
            middle = self.weights @ positions
            positions = (positions - middle) @ self.rotation.T
            lowest = positions[:, 2].min()
            positions[:, 2] -= lowest
            if smooth is not None:
                smooth = (smooth - middle) @ self.rotation.T - (0.0, 0.0, lowest)
        stretch_x, stretch_y = fabric.stretch_xy
        arrays = self._marks.arrays(layout, positions)
        arrays |= smooth_arrays(places.mean_curvature, places.area * stretch_x * stretch_y - 1.0)
        if smooth is not None:
            arrays |= self._marks.arrays(layout, smooth, "smooth")
        return Frame(
            seq,
            stage,
            arrays,
            self._mesh_arrays,
            is_minimum=bool(stage == EQUILIBRIUM and preview.equilibrium.is_minimum),
            height_mm=float(np.ptp(positions[:, 2])),
        )

    @cached_property
    def weights(self) -> Floats:
        """(V,) share of the printed sheet that each vertex stands for."""
        areas = sum_at_vertices(
            self.triangles, np.repeat(triangle_areas(self.printed, self.triangles), 3), len(self.printed)
        )
        return np.asarray(areas / areas.sum())


class TargetComparison:
    """Compares sheets with one target in the pose that is shown; `version` is of both."""

    def __init__(self, target: Surface, version: int) -> None:
        self._version = version
        self._vertices = np.asarray(target.vertices, dtype=float)
        self._triangles = np.asarray(target.triangles, dtype=np.int64)
        self._nearest = NearestOnSurface(self._vertices, self._triangles)

    def measured(self, frame: Frame, weights: Floats) -> Frame:
        """A frame with its distances from the target; each vertex stands for a share (V,) of the sheet."""
        away = np.abs(self._nearest(np.asarray(frame.arrays["positions"], dtype=float)).distance)
        rms = float(np.sqrt(weights @ away**2 / weights.sum()))
        numbers = {"rms_mm": rms, "max_mm": float(away.max()), "version": self._version}
        return replace(frame, arrays=frame.arrays | {"target": away.astype(np.float32)}, target=numbers)

    def pose(self, seq: int, positions: Floats, triangles: Ints) -> TargetPose:
        """The motion that lays the target on a sheet with vertices (V, 3) mm and triangles (T, 3)."""
        samples, _ = surface_samples(self._vertices, self._triangles, MAX_SCAN_POINTS, np.random.default_rng(0))
        best = register(samples, np.asarray(positions, dtype=float), np.asarray(triangles, dtype=np.int64))[0]
        return TargetPose(seq, best.rotation, best.shift)
