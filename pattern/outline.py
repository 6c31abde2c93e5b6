"""The border of a sheet as evenly spaced points, with corners, tips and pins among them."""

from __future__ import annotations

import numpy as np

from pattern.layout import Floats
from pattern.planar import distance_to_segment


def outline_points(border: Floats, edge_mm: float, wanted: Floats, tolerance: float) -> Floats:
    """Points (n, 2) along a polygon, counterclockwise from its first corner.

    Parameters
    ----------
    border : (B, 2) mm.
    edge_mm : wished spacing; between two wanted points it is made even.
    wanted : (W, 2) mm, places that must be among the points if they are on the polygon within `tolerance` (mm).
    """
    pieces = []
    for a, b in zip(border, np.roll(border, -1, axis=0), strict=True):
        side = b - a
        length = float(np.linalg.norm(side))
        on = wanted[distance_to_segment(wanted, a, b) <= tolerance]
        along = (on - a) @ side / length
        free = (along > tolerance) & (along < length - tolerance)
        along, first = np.unique(np.round(along[free] / tolerance) * tolerance, return_index=True)
        # the wanted points themselves, not their feet on the side: vertices must be where tips are
        stops = np.concatenate([a[None], on[free][first], b[None]])
        for start, end in zip(stops[:-1], stops[1:], strict=True):
            n = max(round(float(np.linalg.norm(end - start)) / edge_mm), 1)
            pieces.append(start + np.arange(n)[:, None] / n * (end - start))
    return np.concatenate(pieces)
