"""The kind of pattern of a design: stars, or the motif of drawn rods."""

from __future__ import annotations

from asterism.previews.pattern_kind import PatternKind
from asterism.previews.star_kind import StarKind
from pattern.design.design import Design


def kind_of(design: Design) -> PatternKind:
    """The kind of a design's pattern. A design whose pattern has no preview is refused by the kind's layout."""
    if isinstance(design, Design) and design.rods is not None:
        from asterism.previews.motifs.motif_kind import MotifKind  # designs of stars do without it

        return MotifKind()
    return StarKind()
