"""Lines of a drawing as polylines whose points are close enough to the curve."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.interpolate import CubicSpline

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rods import DrawnArc, DrawnCircle, DrawnLine
from asterism.pattern.geometry.flattening import MAX_PIECE_TURN_RAD, flattened

# points of a spline between two given ones, at which its turn is measured
SPLINE_SAMPLES = 32
SAME_POINT_MM = 1e-6


def polyline(line: DrawnLine, curve_mm: float) -> Floats:
    """(n, 2) mm, the points of a line; the last is the first if it is closed.

    Parameters
    ----------
    curve_mm : largest distance of the curve from the polyline.

    Raises
    ------
    DesignError
        Points that follow each other are the same.

    Examples
    --------
    >>> polyline(DrawnLine(circle_mm={"radius": 10.0}), 1.0).shape
    (91, 2)
    >>> polyline(DrawnLine(line_mm=[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)], closed=True), 1.0).tolist()
    [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 0.0]]
    """
    if line.circle_mm is not None:
        return _arc(line.circle_mm, 0.0, 2 * np.pi, curve_mm)
    if line.arc_mm is not None:
        start, end = np.radians([line.arc_mm.from_deg, line.arc_mm.to_deg])
        return _arc(line.arc_mm, float(start), float(end), curve_mm)
    key = line.outline_shape
    points = np.asarray(getattr(line, key), dtype=float)
    if line.closed and np.linalg.norm(points[0] - points[-1]) > SAME_POINT_MM:
        points = np.concatenate([points, points[:1]])
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if step.min() <= SAME_POINT_MM:
        place = points[step.argmin()]
        raise DesignError(key, f"has a point twice, at [{place[0]:g}, {place[1]:g}]", place_mm=place)
    if len(points) < 4 and line.closed:
        raise DesignError(key, "must have at least three points to be closed")
    return points if key == "line_mm" else _spline(points, step, line.closed, curve_mm)


def _arc(circle: DrawnCircle | DrawnArc, start: float, end: float, curve_mm: float) -> Floats:
    largest = min(2 * np.arccos(max(1 - curve_mm / circle.radius, 0.0)), MAX_PIECE_TURN_RAD)
    angle = np.linspace(start, end, int(np.ceil(abs(end - start) / largest)) + 1)
    points = np.asarray(circle.centre) + circle.radius * np.column_stack([np.cos(angle), np.sin(angle)])
    if circle.__class__ is DrawnCircle:
        points[-1] = points[0]
    return points


def _spline(points: Floats, step: Floats, closed: bool, curve_mm: float) -> Floats:
    """The cubic spline through points over the square root of their distances (centripetal, no loops)."""
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(step))])
    curve = CubicSpline(knots, points, bc_type="periodic" if closed else "natural")
    fine = np.unique(np.concatenate([np.linspace(a, b, SPLINE_SAMPLES + 1) for a, b in pairwise(knots)]))
    out = flattened(curve, fine, curve_mm)
    if closed:
        out[-1] = out[0]
    return out
