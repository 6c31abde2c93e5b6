"""Previews of the motif of drawn rods: the parts of a preview that depend on the kind of pattern."""

from __future__ import annotations

from typing import Any

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.clock import Clock
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.motif_plan import without_motif_law
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.model import PreviewModel
from asterism.previews.motifs.motif_estimate import estimate_motif_error
from asterism.previews.motifs.motif_shape import MotifLens, motif_shape_of, shown_motif_mesh
from asterism.previews.motifs.motif_sheet import MotifSheet, motif_sheet_of
from asterism.previews.motifs.motif_summary import motif_summary
from asterism.previews.motifs.motif_values import MotifFieldValues
from asterism.previews.motifs.serving_motif_law import serving_motif_law
from asterism.previews.pattern_kind import PatternKind
from asterism.previews.state import AnyPreviewState
from asterism.previews.surface.places import Places, SheetLens
from asterism.process.listeners import Say
from asterism.results.records.preview import PreviewRecord
from asterism.shape.shape import Shape


class MotifKind(PatternKind):
    """A motif of drawn rods that repeats on the lattice, and nothing beside it."""

    def layout(self, design: Design) -> Layout:
        """Designs without a law are refused here, before anything is computed."""
        if (refused := without_motif_law(design)) is not None:
            raise DesignError(*refused)
        return print_layout(design)

    def default_law(self, design: Design, plan: Layout, known: Any, say: Say) -> MotifLaw:
        return serving_motif_law(design, plan, known, say)

    def check_law(self, law: Any) -> None:
        check_type(law, MotifLaw, "load_motif_law reads one from a file")

    def values(self, design: Design, plan: Layout, law: MotifLaw, model: PreviewModel) -> MotifFieldValues:
        return MotifFieldValues.of(design, plan, law)

    def sheet(self, design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> MotifSheet:
        return motif_sheet_of(design, plan, triangles, model)

    def size_in_words(self, plan: Layout) -> str:
        rods = len(plan.graph.rods)
        return f"{rods} rod{'s' if rods > 1 else ''}"

    def lens(self, state: AnyPreviewState, points: Floats) -> SheetLens:
        return MotifLens(state.sheet, points)

    def shown_mesh(self, sheet: MotifSheet) -> Mesh:
        return shown_motif_mesh(sheet)

    def shape(self, sheet: MotifSheet, mesh: Mesh, places: Places) -> Shape:
        return motif_shape_of(sheet, mesh, places)

    def summary(
        self, state: AnyPreviewState, shape: Shape, mesh: Mesh, up: Floats, clock: Clock, seconds: dict[str, float]
    ) -> PreviewRecord:
        estimate = estimate_motif_error(state, shape, up, clock)
        return motif_summary(state, shape, mesh, estimate, seconds)
