"""Previews of the motif of drawn rods: the parts of a preview that depend on the kind of pattern."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from asterism.fem.search.relax import is_collapsing
from asterism.homogenize.law.motif_law import MotifLaw
from asterism.homogenize.law.plan import without_law
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.roll_axis import roll_axis_from_normals
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.model import PreviewModel
from asterism.previews.motifs.motif_cover import MotifFieldValues, holes_within_cells
from asterism.previews.motifs.motif_sheet import MotifSheet, motif_sheet_of
from asterism.previews.pattern_kind import PatternKind
from asterism.previews.state import AnyPreviewState
from asterism.previews.summary import common_numbers, count_crossings
from asterism.previews.warnings import form_warnings, shape_warnings, side_warnings, support_warnings
from asterism.results.records.preview import PreviewRecord
from asterism.shape.shape import Shape

# largest Gaussian modulus over the one at which bending becomes indefinite without a warning
MAX_RIM_SHARE = 1.5


def _warnings(state: AnyPreviewState, shape: Shape, crossings: int) -> Iterator[str]:
    """One line each, in the order of their causes: motif, supports, equilibrium, shape."""
    values = state.values
    if values.outside:
        share = 100.0 * len(values.outside) / values.places
        yield (
            f"{share:.0f} % of the rods are outside the law's range, such as {values.outside[0]}; the preview "
            "takes the nearest size in the range"
        )
    collapses = is_collapsing(state.shell, state.equilibrium)
    if collapses:
        yield (
            "not an equilibrium: at wide rims the tension of the fabric bends the preview more than its rods resist; "
            "make the rods thicker or wider, or use the exact model: asterism simulate"
        )
    elif state.sheet.gaussian_share(values) > MAX_RIM_SHARE:
        yield (
            "the tension of the fabric at wide rims bends the sheet as much as its rods do, which the preview "
            "describes roughly; check with the exact model"
        )
    if cut := holes_within_cells(state.layout, state.design.border.tip_margin_mm):
        which = f"hole {cut[0]} is" if len(cut) == 1 else f"hole {cut[0]} and {len(cut) - 1} more are"
        yield (
            f"{which} smaller than a cell of the motif, with rods cut off there, which the preview describes roughly; "
            "check with the exact model"
        )
    yield from support_warnings(state, shape)
    yield from side_warnings(state)
    if not collapses:
        yield from form_warnings(state)
    yield from shape_warnings(crossings)


class MotifKind(PatternKind):
    """A motif of drawn rods that repeats on the lattice, and nothing beside it."""

    shown_edge = 1 / 3

    def layout(self, design: Design) -> Layout:
        """Designs without a law are refused here, before anything is computed."""
        if (refused := without_law(design)) is not None:
            raise refused
        return layout(design)

    def check_law(self, law: Any) -> None:
        check_type(law, MotifLaw, "load_law reads the law of a motif from its file")

    def values(self, design: Design, plan: Layout, law: MotifLaw, model: PreviewModel) -> MotifFieldValues:
        return MotifFieldValues.of(design, plan, law)

    def sheet(self, design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> MotifSheet:
        return motif_sheet_of(design, plan, triangles, model)

    def size_in_words(self, plan: Layout) -> str:
        rods = len(plan.graph.rods)
        return f"{rods} rod{'s' if rods > 1 else ''}"

    def rod_fields(self, sheet: MotifSheet, mesh: Mesh) -> dict[str, np.ndarray]:
        thickness, width = [], []
        for rod, path in zip(sheet.layout.graph.rods, mesh.rods, strict=True):
            steps = np.linalg.norm(np.diff(mesh.points[path], axis=0), axis=1)
            middles = (np.cumsum(steps) - 0.5 * steps) / steps.sum()
            thickness.append(rod.at(rod.thickness, middles))
            width.append(rod.at(rod.width, middles))
        number = np.repeat(np.arange(len(mesh.rods)), [len(path) - 1 for path in mesh.rods])
        return {
            "arm": number,
            "star": np.full(len(number), -1),
            "thickness_mm": np.concatenate(thickness),
            "width_mm": np.concatenate(width),
        }

    def summary(self, state: AnyPreviewState, shape: Shape, mesh: Mesh, seconds: dict[str, float]) -> PreviewRecord:
        layout, law, values = state.layout, state.law, state.values
        nearest = cKDTree(shape.printed).query(layout.sample_points)[1]
        axis = roll_axis_from_normals(layout, shape.point_fields["normal"][nearest])
        crossings = count_crossings(shape)
        numbers = common_numbers(state, shape, mesh, axis, seconds) | {
            "rods_total": len(layout.graph.rods),
            "law": {
                "material": law.plan.design.name,
                "stretch": float(state.design.fabric.stretch_xy[0]),
                "edge_mm": law.edge_mm,
                "made_by": law.made.get("command"),
            },
            "law_in_range": not values.outside,
            "stars_outside_law": [],
            "stars_tight": [],
            "stars_uneven": [],
            "smoothing_mm": 0.0,
            "self_intersections": crossings,
            "warnings": list(_warnings(state, shape, crossings)),
        }
        return PreviewRecord.from_json(numbers)
