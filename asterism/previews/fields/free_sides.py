"""Free sides of a sheet, where arms that point outwards bend the rim (`asterism.previews.fields.rim_arms`).

A side is not free if it is supported along its length, or at a point of a sheet with several supported points: there
the fabric is pulled straight along the rim. Points that slide along the print do not pull. A hole in the pattern, bare
sites enclosed by stars, has no side; a hole in the sheet has sides like the outline.
"""

from __future__ import annotations

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.planar import distance_to_segment, nearest_segment
from asterism.pattern.layout.layout import Layout
from asterism.previews.fields.holes import in_holes

# spacings; a side is supported by points nearer to it than this; origin unknown
RIM_PIN_DISTANCE = 0.5


def free_normals(layout: Layout, points: Floats) -> Floats:
    """(n, 2) unit normals of the sides nearest to printed points (n, 2) mm; zero at supported sides and in holes.

    A side is supported along its length, or at a point if supports fix at least two points of the sheet along the
    print.
    """
    edges = layout.edges
    start, end = edges.start, edges.end
    along = end - start
    nearest = nearest_segment(points, start, end)
    normal = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    normal[layout.supported_edges] = 0.0
    pins = layout.in_plane_pin_points
    if len(pins) > 1:
        near = RIM_PIN_DISTANCE * layout.spacing_mm
        held = (distance_to_segment(pins[:, None], start, end) < near).any(axis=0)
        side = edges.straight_sides
        normal[np.isin(side, side[held])] = 0.0
    return np.where(in_holes(layout, points)[:, None], 0.0, normal[nearest])
