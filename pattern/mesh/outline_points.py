"""Points along the outline of a sheet, evenly spaced, with corners, tips and pins among them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.planar import distance_to_segment

# shortest edge beside vertices close to the outline, over the requested edge
MIN_OUTLINE_EDGE_FACTOR = 0.3


def outline_points(border: Floats, edge_mm: float, wanted: Floats, tolerance: float, beside: Floats) -> Floats:
    """Points (n, 2) along a polygon, counterclockwise from its first corner.

    Parameters
    ----------
    border : (B, 2) mm.
    edge_mm : requested edge length; edges are even between corners and wanted points, except beside `beside`.
    wanted : (W, 2) mm, places that become points if they are on the polygon within `tolerance` (mm).
    beside : (N, 2) mm, vertices inside: edges are at most as long as their distance.
    """
    pieces = []
    near = cKDTree(beside)
    for a, b in zip(border, np.roll(border, -1, axis=0), strict=True):
        side = b - a
        length = float(np.linalg.norm(side))
        on = wanted[distance_to_segment(wanted, a, b) <= tolerance]
        along = (on - a) @ side / length
        free = (along > tolerance) & (along < length - tolerance)
        along, first = np.unique(np.round(along[free] / tolerance) * tolerance, return_index=True)
        # the wanted points themselves, not their feet on the side: vertices must be where tips are
        stops = np.concatenate([a[None], on[free][first], b[None]])
        for start, end in pairwise(stops):
            pieces.append(start + _spread(start, end, edge_mm, near)[:-1, None] * (end - start))
    return np.concatenate(pieces)


def _spread(start: Floats, end: Floats, edge_mm: float, near: cKDTree) -> Floats:
    """Parts (n + 1,) of a stretch, from 0 to 1, whose steps follow the distance to what is near."""
    length = float(np.linalg.norm(end - start))
    samples = np.linspace(0, 1, max(int(np.ceil(16 * length / edge_mm)), 1) + 1)
    size = near.query(start + ((samples[1:] + samples[:-1]) / 2)[:, None] * (end - start))[0]
    steps = np.cumsum(np.diff(samples) * length / np.clip(size, MIN_OUTLINE_EDGE_FACTOR * edge_mm, edge_mm))
    n = max(round(float(steps[-1])), 1)
    if size.min() >= edge_mm:
        return np.arange(n + 1) / n
    return np.asarray(np.interp(np.arange(n + 1) / n * steps[-1], np.concatenate([[0.0], steps]), samples))
