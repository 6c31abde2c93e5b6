"""A preview as the page shows it: one mesh of the printed sheet, and the arrays of each stage on it."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.geometry.normals import sum_at_vertices, triangle_normals
from asterism.pattern.geometry.planar import triangle_areas
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.session import Preview
from asterism.shape.pose import upright_rotation
from asterism.studio.messages import Frame, ShownMesh
from asterism.studio.sheet_frames import SheetMarks, mesh_message, ribbon_stations


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
        self._number = 0
        self._arm_site: Ints = np.empty(0, dtype=np.int64)
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

    def has_arms_of(self, layout: Layout) -> bool:
        """Whether the mesh was numbered for a layout with ribbons of the same stars, and as many along drawn rods."""
        return self._number > 0 and np.array_equal(ribbon_stations(layout).site, self._arm_site)

    def numbered(self, number: int, layout: Layout) -> ShownMesh:
        """The message with the mesh, under a new number."""
        self._number, self._arm_site = number, ribbon_stations(layout).site
        return mesh_message(number, self.printed, self.triangles, self._arm_site)

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
        """The arrays of a stage with positions x (N, 3) of the shell's dofs; by default what the preview shows.

        With `has_smooth`, the frame also holds the sheet without its bumps.
        """
        layout, fabric = preview.sheet.layout, preview.design.fabric
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
        return Frame.of(
            self._marks.part(layout, positions),
            seq,
            self._number,
            stage,
            places.surface.mean_curvature,
            places.surface.area * stretch_x * stretch_y - 1.0,
            is_minimum=stage == "equilibrium" and preview.equilibrium.is_minimum,
            height_mm=float(np.ptp(positions[:, 2])),
            smooth=None if smooth is None else self._marks.part(layout, smooth),
        )

    @cached_property
    def weights(self) -> Floats:
        """(V,) share of the printed sheet that each vertex stands for."""
        areas = sum_at_vertices(
            self.triangles, np.repeat(triangle_areas(self.printed, self.triangles), 3), len(self.printed)
        )
        return np.asarray(areas / areas.sum())
