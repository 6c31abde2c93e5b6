"""The kind of pattern of a design, with the parts of a preview that depend on it."""

from __future__ import annotations

from asterism.previews.pattern_kind import PatternKind
from asterism.previews.star_kind import StarKind
from pattern.design.design import Design


def kind_of(design: Design) -> PatternKind:
    """The kind of a design's pattern. Designs without a preview are refused by the layout of their kind."""
    return StarKind()
