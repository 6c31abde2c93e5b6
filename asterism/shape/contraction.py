"""Contraction of a sheet."""

from __future__ import annotations

import numpy as np

from asterism.pattern.layout.layout import Layout
from asterism.shape.shape import Shape


def contraction(layout: Layout, shape: Shape) -> float | None:
    """Mean distance of neighbouring star centres in space over that in print; None for a single star.

    Of a drawing without stars, the same of neighbouring sites of its lattice: that of its motif, or a square lattice
    with the mean distance of its rods.
    """
    pairs = layout.sample_pairs
    if len(pairs) == 0:
        return None
    printed = layout.sample_points
    at = shape.positions[shape.star_vertices] if layout.has_stars else shape.at(printed, layout.spacing_mm)
    places = at, printed
    in_space, in_print = (np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1) for centres in places)
    return float(in_space.mean() / in_print.mean())
