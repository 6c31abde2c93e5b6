"""Points of a mesh along rods and around holes, even between their ends, corners and pins."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.geometry.planar import turning_angles
from asterism.pattern.rods.graph import CORNER_DEG, Rod

# a segment of a curved line turns by less
MAX_SEGMENT_TURN_RAD = np.radians(20.0)


def least_pieces(rod: Rod) -> float:
    """The smallest number of segments of a rod: two, and more where it curves."""
    return max(2.0, float(np.ceil(rod.turn / MAX_SEGMENT_TURN_RAD)))


def points_along(rod: Rod, step: float, pins: Floats, tolerance: float) -> Floats:
    """(n, 2) mm, points of a rod from its start to its end, about `step` (mm) apart, and the pins (P, 2) on it."""
    if len(pins):
        low, high = rod.points.min(axis=0) - tolerance, rod.points.max(axis=0) + tolerance
        pins = pins[((pins >= low) & (pins <= high)).all(axis=1)]
    at, stops = np.array([0.0, rod.length]), rod.points[[0, -1]]
    if len(pins):
        line, places = shapely.LineString(rod.points), shapely.points(pins)
        along = np.asarray(shapely.line_locate_point(line, places), dtype=float)
        inner = (shapely.distance(line, places) <= tolerance) & (along > tolerance) & (along < rod.length - tolerance)
        order = np.flatnonzero(inner)[np.argsort(along[inner])]
        at, stops = np.insert(at, 1, along[order]), np.insert(stops, 1, pins[order], axis=0)
    pieces = []
    for k, (a, b) in enumerate(pairwise(at)):
        parts = np.linspace(a, b, max(round((b - a) / step), 1) + 1)[1:-1] / rod.length
        pieces += [stops[k : k + 1], rod.at(rod.points, parts)]
    return np.concatenate([*pieces, stops[-1:]])


def points_around(ring: Floats, step: float, pins: Floats, tolerance: float) -> Floats:
    """(n, 2) mm, points of the edge (m, 2) of a hole, from corner to corner and about `step` (mm) apart.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    >>> len(points_around(square, 2.0, np.empty((0, 2)), 1e-6))
    8
    """
    corners = np.flatnonzero(np.abs(turning_angles(ring)) > np.radians(CORNER_DEG))
    first = int(corners[0]) if len(corners) else 0
    closed = np.concatenate([np.roll(ring, -first, axis=0), ring[first : first + 1]])
    stops = [*(corners - first), len(ring)] if len(corners) else [0, len(ring)]
    none = np.zeros(len(closed))
    pieces = []
    for a, b in pairwise(stops):
        side = Rod(closed[a : b + 1], 0, 1, none[a : b + 1], none[a : b + 1])
        # a side of a polygon may be one edge, a curve has more
        count = max(np.rint(side.length / step), 1.0, np.ceil(side.turn / MAX_SEGMENT_TURN_RAD))
        pieces.append(points_along(side, side.length / count, pins, tolerance)[:-1])
    return np.concatenate(pieces)


def place_within(ring: Floats) -> Floats:
    """(2,) mm, a place within a closed line (n, 2)."""
    return np.asarray(shapely.get_coordinates(shapely.point_on_surface(shapely.Polygon(ring)))[0])
