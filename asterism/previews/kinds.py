"""The kind of pattern of a design: stars, or the motif of drawn rods."""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.law.star_law import StarLaw
from asterism.pattern.design.arguments import check_type
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from asterism.pattern.mesh.mesh import Mesh
from asterism.previews.fields.star_values import StarValues, star_values
from asterism.previews.model import PreviewModel
from asterism.previews.pattern_kind import PatternKind
from asterism.previews.places import SheetLens
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.sheet import Sheet, sheet_of
from asterism.previews.star_lens import StarLens
from asterism.previews.state import StarState
from asterism.previews.summary import summary
from asterism.results.records.preview import PreviewRecord
from asterism.shape.shape import Shape


class StarKind(PatternKind):
    """Stars on a lattice."""

    shown_edge = 1 / 6

    def layout(self, design: Design) -> Layout:
        return layout(design)

    def check_law(self, law: Any) -> None:
        check_type(law, StarLaw, "load_law reads one from a file")

    def values(self, design: Design, plan: Layout, law: StarLaw, model: PreviewModel) -> StarValues:
        return star_values(design, plan, law, model)

    def sheet(self, design: Design, plan: Layout, triangles: int | None, model: PreviewModel) -> Sheet:
        return sheet_of(design, plan, triangles, model)

    def size_in_words(self, plan: Layout) -> str:
        stars = len(plan.centres)
        return f"{stars} star{'s' if stars > 1 else ''}"

    def lens(self, state: StarState, points: Floats) -> SheetLens:
        return StarLens(state.sheet, state.law.waves, points)

    def rod_fields(self, sheet: Sheet, mesh: Mesh) -> dict[str, np.ndarray]:
        layout, counts = sheet.layout, np.array([len(path) for path in mesh.rods])
        arm = np.repeat(np.arange(len(counts)), counts)
        step = np.linalg.norm(np.diff(mesh.points[np.concatenate(mesh.rods)], axis=0), axis=1)
        within = arm[1:] == arm[:-1]  # false for steps from one arm to the next
        arms, step = arm[1:][within], step[within]
        total = np.bincount(arms, step)
        before = np.cumsum(total) - total
        part = (np.cumsum(step) - 0.5 * step - before[arms]) / total[arms]
        ends = {"thickness_mm": layout.arm_thickness, "width_mm": layout.arm_width}
        return {
            "arm": arms,
            "star": layout.star_number[layout.arm_star[arms]],
            **{name: (1.0 - part) * both[arms, 0] + part * both[arms, 1] for name, both in ends.items()},
        }

    def summary(self, state: StarState, shape: Shape, mesh: Mesh, seconds: dict[str, float]) -> PreviewRecord:
        return summary(state, shape, mesh, seconds)


def kind_of(design: Design) -> PatternKind:
    """The kind of a design's pattern. A design whose pattern has no preview is refused by the kind's layout."""
    if isinstance(design, Design) and design.rods is not None:
        from asterism.previews.motifs.motif_kind import MotifKind  # designs of stars do without it

        return MotifKind()
    return StarKind()


def serves(sheet: PrintSheet, design: Design, plan: Layout) -> bool:
    """Whether a sheet serves a design with its layout: the same print, and a pattern of the same kind."""
    return type(kind_of(sheet.design)) is type(kind_of(design)) and sheet.is_same_print(design, plan)
