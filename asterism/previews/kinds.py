"""The kind of pattern of a design: stars, or the motif of drawn rods."""

from __future__ import annotations

from asterism.pattern.design.design import Design
from asterism.pattern.layout.layout import Layout
from asterism.previews.pattern_kind import PatternKind
from asterism.previews.print_sheet import PrintSheet
from asterism.previews.star_kind import StarKind


def kind_of(design: Design) -> PatternKind:
    """The kind of a design's pattern. A design whose pattern has no preview is refused by the kind's layout."""
    if isinstance(design, Design) and design.rods is not None:
        from asterism.previews.motifs.motif_kind import MotifKind  # designs of stars do without it

        return MotifKind()
    return StarKind()


def serves(sheet: PrintSheet, design: Design, plan: Layout) -> bool:
    """Whether a sheet serves a design with its layout: the same print, and a pattern of the same kind."""
    return type(kind_of(sheet.design)) is type(kind_of(design)) and sheet.is_same_print(design, plan)
