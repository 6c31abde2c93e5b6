"""The vertices of a mesh at which the sheet is supported."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_outline, distance_to_segment, inside
from asterism.pattern.layout.layout import Layout

# a vertex this close to a pin is at the pin
PIN_VERTEX_TOLERANCE_MM = 1e-5


def pins_on_sheet(layout: Layout) -> Floats:
    """The layout's pin points (P, 2) in mm; a point off the sheet is refused."""
    points = layout.pin_points
    on_border = distance_to_outline(points, layout.outline) <= PIN_VERTEX_TOLERANCE_MM
    off = ~(on_border | inside(points, layout.outline))
    for hole in layout.holes:
        off |= inside(points, hole) & (distance_to_outline(points, hole) > PIN_VERTEX_TOLERANCE_MM)
    if off.any():
        x, y = points[np.argmax(off)]
        raise MeshError(f"the pin at ({x:g}, {y:g}) mm is not on the sheet")
    return points


def pin_vertices(layout: Layout, points: Floats, rim_vertices: Ints) -> tuple[Ints, ...]:
    """Vertices of each pin set: those at its points, in their order, then those on its edges of the sheet.

    Parameters
    ----------
    points : (V, 2) mm, vertices of the mesh.
    rim_vertices : those of the outline and of the edges of holes.
    """
    if not layout.pins:
        return ()
    tree = cKDTree(points)
    result = []
    for pin in layout.pins:
        distance, at = tree.query(pin.points)
        if (distance > PIN_VERTEX_TOLERANCE_MM).any():
            x, y = pin.points[np.argmax(distance)]
            raise MeshError(f"no mesh vertex at the pin at ({x:g}, {y:g}) mm")
        held: list[Ints] = [np.asarray(at, dtype=np.int64)]
        for a, b in pin.segments(layout.edges):
            on = distance_to_segment(points[rim_vertices], a, b) <= PIN_VERTEX_TOLERANCE_MM
            held.append(rim_vertices[on])
        vertices = np.concatenate(held)
        _, first = np.unique(vertices, return_index=True)
        # points keep their order and number: targets go with them
        keep = np.union1d(first, np.arange(len(at)))
        result.append(vertices[keep])
    return tuple(result)
