"""Lines of a drawing and edges of holes as polylines whose points are close enough to the curve."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from scipy.interpolate import CubicSpline

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.border import MIN_SHEET_AREA_MM2, Border
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rods import DrawnLine
from asterism.pattern.design.section import Point
from asterism.pattern.geometry.flattening import MAX_PIECE_TURN_RAD, flattened
from asterism.pattern.geometry.planar import polygon_area, shown_place

# points of a spline between two given ones, at which its turn is measured
SPLINE_SAMPLES = 32
SAME_POINT_MM = 1e-6
# keys of holes by those of lines of the same shape
_LINE_OF_EDGE = {"circle_mm": "circle_mm", "polygon_mm": "line_mm", "spline_mm": "spline_mm"}


def polyline(line: DrawnLine, curve_mm: float) -> Floats:
    """(n, 2) mm, the points of a line; the last is the first if it is closed.

    Raises `DesignError` if points that follow each other are the same.

    >>> polyline(DrawnLine(circle_mm={"radius": 10.0}), 1.0).shape
    (91, 2)
    >>> polyline(DrawnLine(line_mm=[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)], closed=True), 1.0).tolist()
    [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 0.0]]
    """
    if line.circle_mm is not None:
        points = line.circle_mm.at(_angles(line.circle_mm.half_axes, 0.0, 2 * np.pi, curve_mm))
        points[-1] = points[0]
        return points
    if (arc := line.arc_mm) is not None:
        start, end = np.radians([arc.from_deg, arc.to_deg])
        return _arc(arc.centre, arc.radius, float(start), float(end), curve_mm)
    points, step = _given_points(line)
    if line.outline_shape == "line_mm":
        return points
    curve, knots = _spline(points, step, line.closed)
    fine = np.unique(np.concatenate([np.linspace(a, b, SPLINE_SAMPLES + 1) for a, b in pairwise(knots)]))
    out = flattened(curve, fine, curve_mm)
    if line.closed:
        out[-1] = out[0]
    return out


def _given_points(line: DrawnLine) -> tuple[Floats, Floats]:
    """(n, 2) mm, the points that a line passes through, with the first again if it is closed, and their distances."""
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
    return points, step


def _angles(half_axes: Point, start: float, end: float, curve_mm: float) -> Floats:
    """(n,) rad, along a part of an ellipse; steps of the angle turn the curve most at the ends of the long axis."""
    short, long = sorted(half_axes)
    largest = min(2 * np.arccos(max(1 - curve_mm / long, 0.0)), MAX_PIECE_TURN_RAD * short / long)
    return np.linspace(start, end, int(np.ceil(abs(end - start) / largest)) + 1)


def _arc(centre: Floats | Point, radius: float, start: float, end: float, curve_mm: float) -> Floats:
    """(n, 2) mm, a part of a circle between two angles."""
    angle = _angles((radius, radius), start, end, curve_mm)
    return np.asarray(centre) + radius * np.column_stack([np.cos(angle), np.sin(angle)])


def _spline(points: Floats, step: Floats, closed: bool) -> tuple[CubicSpline, Floats]:
    """The cubic spline through points over the square root of their distances (centripetal, no loops), and knots."""
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(step))])
    return CubicSpline(knots, points, bc_type="periodic" if closed else "natural"), knots


def curved_outline(border: Border, curve_mm: float) -> Floats:
    """(n, 2) mm, the outline that arcs over the edges of a polygon make, or a spline; the given points are among them.

    >>> square = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)]
    >>> curved_outline(Border(polygon_mm=square, bulge_mm=(-0.3, 0.0, 0.0, 0.0)), 0.1).round(3).tolist()
    [[-9.0, -9.0], [0.0, -8.7], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]
    """
    if border.spline_mm is None:
        return _bent(np.asarray(border.polygon_mm), border.bulge_mm or (), curve_mm)
    curve, knots = _spline(*_given_points(DrawnLine(spline_mm=border.spline_mm, closed=True)), closed=True)
    spans = [np.linspace(a, b, SPLINE_SAMPLES + 1) for a, b in pairwise(knots)]
    return np.concatenate([flattened(curve, span, curve_mm)[:-1] for span in spans])


def _bent(corners: Floats, bulges: Sequence[float], curve_mm: float) -> Floats:
    """The ring (n, 2) mm of a polygon whose edges are arcs; a positive bulge makes the polygon larger."""
    outward = np.sign(polygon_area(corners))
    pieces = []
    for a, b, bulge in zip(corners, np.roll(corners, -1, axis=0), bulges, strict=False):
        pieces.append(a[None])
        if abs(bulge) <= curve_mm:
            continue
        # the arc turns left by so much about a centre to the left of the edge, or right about one to the right
        turn = 4.0 * outward * np.arctan(2.0 * bulge / np.linalg.norm(b - a))
        centre = 0.5 * (a + b) + 0.5 / np.tan(0.5 * turn) * np.array([a[1] - b[1], b[0] - a[0]])
        x, y = a - centre
        start = float(np.arctan2(y, x))
        pieces.append(_arc(centre, float(np.hypot(x, y)), start, start + turn, curve_mm)[1:-1])
    return np.concatenate(pieces)


def hole_rings(border: Border, curve_mm: float) -> list[tuple[str, Floats]]:
    """The holes that are no drawn rods: the field that names each one, and its edge (n, 2) mm, not closed.

    >>> border = Border.model_validate(
    ...     {"rectangle_mm": [40.0, 40.0], "holes": [{"polygon_mm": [[0, 0], [9, 0], [0, 9]]}]}
    ... )
    >>> [(name, len(ring)) for name, ring in hole_rings(border, 0.01)]
    [('border.holes[0]', 3)]
    """
    rings = []
    for k, hole in enumerate(border.holes):
        name = f"border.holes[{k}]"
        try:
            if (key := _LINE_OF_EDGE.get(hole.kind)) is not None:
                line = DrawnLine.model_validate({key: getattr(hole, hole.kind), "closed": key != "circle_mm"})
                ring = polyline(line, curve_mm)[:-1]
                rings.append((name, ring if hole.bulge_mm is None else _bent(ring, hole.bulge_mm, curve_mm)))
        except DesignError as error:
            raise DesignError(f"{name}.{hole.kind}", error.allowed, place_mm=error.place_mm) from None
        rings += [(name, np.array(ring)) for ring in hole.rings_mm]
    return rings


def check_holes(rings: Sequence[tuple[str, Floats]], corners: Floats, margin_mm: float) -> None:
    """Refuse edges that cross themselves, the outline (B, 2) mm or each other, or leave less fabric than a margin.

    Raises `DesignError`; the message names the hole and the place.
    """
    if not rings:
        return
    polygons = [shapely.Polygon(ring) for _, ring in rings]
    for (name, _), polygon in zip(rings, polygons, strict=True):
        if not shapely.is_valid(polygon):
            place = shapely.is_valid_reason(polygon).rpartition("[")[2].rstrip("]").split()
            raise DesignError(name, f"must not cross or touch itself, as at [{', '.join(place)}]")
        if polygon.area < MIN_SHEET_AREA_MM2:
            raise DesignError(name, f"must enclose at least {MIN_SHEET_AREA_MM2:g} mm2", round(polygon.area, 4))
    sheet, outline = shapely.Polygon(corners), shapely.LinearRing(corners)
    for (name, _), polygon in zip(rings, polygons, strict=True):
        if not shapely.covers(sheet, polygon):
            parts = shapely.get_coordinates(shapely.difference(polygon, sheet))
            crossing = shapely.get_coordinates(shapely.intersection(polygon.exterior, outline))
            place = crossing[0] if len(crossing) else parts[0]
            raise DesignError(name, f"must be inside the outline, and is not at {shown_place(place)}", place_mm=place)
        _check_gap(name, "the outline", polygon.exterior, outline, margin_mm)
    first, second = shapely.STRtree(polygons).query(polygons, predicate="dwithin", distance=margin_mm)
    for i, j in zip(first[first < second], second[first < second], strict=True):
        names = rings[i][0], rings[j][0]
        if shapely.intersects(polygons[i], polygons[j]):
            place = shapely.get_coordinates(shapely.point_on_surface(shapely.intersection(polygons[i], polygons[j])))[0]
            raise DesignError(
                names[1], f"must be apart from {names[0]}, which it meets at {shown_place(place)}", place_mm=place
            )
        _check_gap(names[1], names[0], polygons[j], polygons[i], margin_mm)


def _check_gap(name: str, other: str, shape: shapely.Geometry, beside: shapely.Geometry, margin_mm: float) -> None:
    """Refuse two shapes nearer than a margin."""
    gap = float(shapely.distance(shape, beside))
    if gap < margin_mm:
        place = shapely.get_coordinates(shapely.shortest_line(shape, beside)).mean(axis=0)
        problem = f"must leave {margin_mm:g} mm of fabric beside {other} (border.tip_margin_mm), leaves {gap:.3f} mm"
        raise DesignError(name, f"{problem} at {shown_place(place)}", place_mm=place)
