"""How far points of a curved outline lie off a mesh, whose edges are its chords."""

from __future__ import annotations

import numpy as np

from asterism.pattern.layout.layout import Layout

# a vertex on a curved outline is off the chord of another mesh by less than this part of the mean edge: chords turn by
# at most 20 degrees, which is a distance of 0.05 chords, and edges of coarser meshes are at most three times as long
OFF_SHEET_EDGES = 0.2
# of the spacing: images of an outline under its symmetries are off it by less
OFF_SYMMETRIC_SPACINGS = 2e-6


def off_curves_mm(layout: Layout, vertices: int) -> float:
    """`off_sheet_mm` if the sheet has a printed rim or holes, which may be curved; else that of symmetric images."""
    if layout.rim or layout.holes:
        return off_sheet_mm(layout, vertices)
    return OFF_SYMMETRIC_SPACINGS * layout.spacing_mm


def off_sheet_mm(layout: Layout, vertices: int) -> float:
    """Largest distance of points on the edges of a layout from a mesh with so many vertices, for `Shape.at`.

    Examples
    --------
    >>> from asterism.pattern.gallery import load
    >>> from asterism.pattern.layout.build import layout
    >>> round(off_sheet_mm(layout(load("dome")), 3781), 2)
    0.35
    """
    return float(OFF_SHEET_EDGES * np.sqrt(layout.area_mm2 / vertices))
