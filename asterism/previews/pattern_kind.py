"""What a preview does differently for each kind of pattern: law, values, sheet, positions, shape and summary.

`asterism.previews.kinds.kind_of` gives the kind of a design. All else, from supports to search, is common to all kinds.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import replace
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.pattern.mesh.meshing import mesh_layout
from asterism.previews.model import PreviewModel
from asterism.previews.places import Places, SheetLens, ShownSheet
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.state import AnyPreviewState
from asterism.results.records.preview import PreviewRecord
from asterism.shape.shape import Shape
from asterism.shape.surface_fields import cell_fields


class PatternKind(ABC):
    """A kind of pattern that has previews.

    Attributes
    ----------
    shown_edge : least edge of the triangles of a preview's shape, over the spacing of the lattice.
    """

    shown_edge: float

    @abstractmethod
    def layout(self, design: Design) -> Layout:
        """The layout of a design, with pins that can carry its weight.

        Raises
        ------
        DesignError
            The design cannot be printed, or has no preview.
        """

    @abstractmethod
    def check_law(self, law: Any) -> None:
        """Refuse objects that are not laws of this kind with a `TypeError`."""

    @abstractmethod
    def values(self, design: Design, plan: Layout, law: Any, model: PreviewModel) -> Any:
        """The law at the stars, or at the sizes of the sheet's rods.

        Raises
        ------
        LawError
            The law is for another material, or its values are impossible for a sheet.
        """

    @abstractmethod
    def sheet(self, design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> PrintSheet:
        """The printed sheet and its mesh of about a number of triangles."""

    @abstractmethod
    def size_in_words(self, plan: Layout) -> str:
        """How many stars or rods there are, for messages."""

    def lens(self, state: AnyPreviewState, points: Floats) -> SheetLens:
        """Computes the positions of printed points (n, 2) mm on a state's sheet."""
        return SheetLens(state.sheet, points)

    @abstractmethod
    def rod_fields(self, sheet: Any, mesh: Mesh) -> dict[str, np.ndarray]:
        """Fields of the rod edges: number of the rod, its star, and thickness and width at the middle of the edge."""

    def shape(self, sheet: PrintSheet, mesh: Mesh, places: Places) -> Shape:
        """The shape with bumps, without a summary.

        The field `bump_mm` holds the vectors from the smooth surface to the shape. Normals, curvatures and strains are
        those of the smooth surface.
        """
        star = np.full(len(mesh.points), -1, dtype=np.int64)
        star[mesh.star_vertices] = sheet.layout.star_number
        return Shape(
            printed=mesh.points,
            positions=places.bumpy,
            triangles=mesh.triangles,
            star=star,
            rods=mesh.rods,
            star_vertices=mesh.star_vertices,
            point_fields={
                "bump_mm": places.bumps,
                "normal": places.surface.normals,
                "mean_curvature_per_mm": places.surface.mean_curvature,
                "gaussian_curvature_per_mm2": places.surface.gaussian_curvature,
            },
            cell_fields=cell_fields(mesh.points, places.smooth, mesh.triangles, sheet.design.fabric.stretch_xy),
            rod_fields=self.rod_fields(sheet, mesh),
            held=bool(sheet.layout.pins),
            plan=sheet.layout,
        )

    @abstractmethod
    def summary(self, state: AnyPreviewState, shape: Shape, mesh: Mesh, seconds: dict[str, float]) -> PreviewRecord:
        """The record of a shape on a mesh."""

    def with_shown_sheet(self, state: AnyPreviewState, clock: Clock) -> AnyPreviewState:
        """The state with triangles to show, with rods along their edges.

        Edges have the length of the design's, but at least `shown_edge` spacings.
        """
        if state.shown is not None:
            return state
        design = state.design
        edge = max(design.usual_edge_mm, self.shown_edge * design.lattice.spacing_mm)
        with clock("shown"):
            mesh = mesh_layout(state.layout, edge, design.mesh.kind, design.mesh.seed, draft=True)
            lens = self.lens(state, mesh.points)
        return replace(state, shown=ShownSheet(mesh, lens))
