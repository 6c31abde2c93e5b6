"""Contraction of a sheet."""

from __future__ import annotations

import numpy as np

from asterism.shape.shape import Shape
from pattern.layout.layout import Layout


def contraction(layout: Layout, shape: Shape) -> float | None:
    """Mean distance of neighbouring star centres in space over that in print; None for a single star."""
    pairs = layout.neighbours
    if len(pairs) == 0:
        return None
    places = shape.positions[shape.star_vertices], layout.centres
    in_space, in_print = (np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1) for centres in places)
    return float(in_space.mean() / in_print.mean())
