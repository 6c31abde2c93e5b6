"""Points along the outline of a sheet, evenly spaced, with corners, tips and pins among them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.design.stars import ROD_SIZES
from asterism.pattern.geometry.planar import distance_to_segment, turning_angles
from asterism.pattern.layout.layout import Layout
from asterism.pattern.rods.graph import CORNER_DEG, Rod

# a segment of a curved line turns by less
MAX_SEGMENT_TURN_RAD = np.radians(20.0)
# a vertex this close to a pin is at the pin
PIN_VERTEX_TOLERANCE_MM = 1e-5


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
    # edges beside vertices close to the outline are not shorter than 0.3 of the requested one
    steps = np.cumsum(np.diff(samples) * length / np.clip(size, 0.3 * edge_mm, edge_mm))
    n = max(round(float(steps[-1])), 1)
    if size.min() >= edge_mm:
        return np.arange(n + 1) / n
    return np.asarray(np.interp(np.arange(n + 1) / n * steps[-1], np.concatenate([[0.0], steps]), samples))


def least_pieces(rod: Rod) -> float:
    """The smallest number of segments of a rod: two, and more where it curves."""
    return max(2.0, float(np.ceil(rod.turn / MAX_SEGMENT_TURN_RAD)))


def points_along(rod: Rod, step: float, wanted: Floats, tolerance: float, is_straight: bool = False) -> Floats:
    """(n, 2) mm, points of a rod from its start to its end, about `step` (mm) apart, and those wanted (W, 2) on it."""
    low, high = rod.points.min(axis=0) - tolerance, rod.points.max(axis=0) + tolerance
    wanted = wanted[((wanted >= low) & (wanted <= high)).all(axis=1)]
    at, stops = np.array([0.0, rod.length]), rod.points[[0, -1]]
    if len(wanted):
        line, places = shapely.LineString(rod.points), shapely.points(wanted)
        along = np.asarray(shapely.line_locate_point(line, places), dtype=float)
        inner = (shapely.distance(line, places) <= tolerance) & (along > tolerance) & (along < rod.length - tolerance)
        order = np.flatnonzero(inner)[np.argsort(along[inner])]
        order = order[np.diff(along[order], prepend=0.0) > tolerance]
        at, stops = np.insert(at, 1, along[order]), np.insert(stops, 1, wanted[order], axis=0)
    pieces = []
    for k, (a, b) in enumerate(pairwise(at)):
        count = max(round((b - a) / step), 1)
        if is_straight:
            pieces.append(np.linspace(stops[k], stops[k + 1], count + 1)[:-1])
        else:
            pieces += [stops[k : k + 1], rod.at(rod.points, np.linspace(a, b, count + 1)[1:-1] / rod.length)]
    return np.concatenate([*pieces, stops[-1:]])


def points_around(ring: Floats, step: float, pins: Floats, tolerance: float) -> Floats:
    """(n, 2) mm, points of the edge (m, 2) of a hole, from corner to corner and about `step` (mm) apart.

    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    >>> len(points_around(square, 2.0, np.empty((0, 2)), 1e-6))
    8
    """
    corners = np.flatnonzero(np.abs(turning_angles(ring)) > np.radians(CORNER_DEG))
    first = int(corners[0]) if len(corners) else 0
    closed = np.concatenate([np.roll(ring, -first, axis=0), ring[first : first + 1]])
    stops = [*(corners - first), len(ring)] if len(corners) else [0, len(ring)]
    none = np.zeros((len(closed), len(ROD_SIZES)))
    pieces = []
    for a, b in pairwise(stops):
        side = Rod(closed[a : b + 1], 0, 1, none[a : b + 1])
        # a side of a polygon may be one edge, a curve has more
        count = max(np.rint(side.length / step), 1.0, np.ceil(side.turn / MAX_SEGMENT_TURN_RAD))
        pieces.append(points_along(side, side.length / count, pins, tolerance)[:-1])
    return np.concatenate(pieces)


def place_within(ring: Floats) -> Floats:
    """(2,) mm, a place within a closed line (n, 2)."""
    return np.asarray(shapely.get_coordinates(shapely.point_on_surface(shapely.Polygon(ring)))[0])


def pin_vertices(layout: Layout, points: Floats, rim_vertices: Ints) -> tuple[Ints, ...]:
    """Vertices of each pin set: those at its points, in their order, then those on its edges of the sheet."""
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
