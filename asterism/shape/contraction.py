"""How much a sheet has contracted."""

from __future__ import annotations

import numpy as np

from asterism.shape.shape import Shape
from pattern.layout.layout import Layout


def contraction(layout: Layout, shape: Shape) -> float | None:
    """Mean distance of neighbouring star centres over the printed one; None for a star alone."""
    pairs = layout.neighbours
    if len(pairs) == 0:
        return None
    places = shape.positions[shape.star_vertices], layout.centres
    now, before = (np.linalg.norm(centres[pairs[:, 0]] - centres[pairs[:, 1]], axis=1) for centres in places)
    return float(now.mean() / before.mean())
