"""Where the pins of a design are on its sheet."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.pins import Pins
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.support_curve import SupportCurve
from asterism.pattern.layout.supports import FIXED_BY_SLIDE, PinSet

# Pins closer than this to a corner, the outline, an arm or another pin are there: a needle is thicker.
PIN_TOLERANCE_MM = 0.25
_NO_POINTS: Floats = np.empty((0, 2))


def pin_set(pins: Pins, corners: Floats, name: str, holes: Sequence[Floats] = ()) -> PinSet:
    """The pins of one entry of `[[pins]]`.

    Parameters
    ----------
    corners : (B, 2) mm, the outline.
    name : of the entry in messages, e.g. `pins[0]`.
    holes : (n, 2) mm each, their edges.

    Raises
    ------
    DesignError
        An edge, a corner or a hole does not exist, a point is off the sheet, points and targets differ in number, or
        edges with targets do not follow each other.
    """
    points, edges = _selected(pins, corners, name, holes)
    target = curve = None
    if pins.target_mm is not None:
        target = np.asarray(pins.target_mm)
        if edges:
            curve = _curve(target, edges, corners, name)
        elif len(target) != len(points):
            raise DesignError(f"{name}.target_mm", f"must have {len(points)} places, one a point", len(target))
    return PinSet(points, edges, FIXED_BY_SLIDE[pins.slide], pins.scale, pins.offset_mm, target, pins.step, curve)


def _curve(target: Floats, edges: tuple[int, ...], corners: Floats, name: str) -> SupportCurve:
    """The curve through the targets (k, 3) mm of the corners along edges."""
    count = len(corners)
    for k, (edge, following) in enumerate(itertools.pairwise(edges)):
        if following != (edge + 1) % count:
            allowed = f"with target_mm, must be {(edge + 1) % count}: the edges of a curve follow each other"
            raise DesignError(f"{name}.edges[{k + 1}]", allowed, following)
    is_closed = len(edges) == count
    needed = count if is_closed else len(edges) + 1
    if len(target) != needed:
        raise DesignError(f"{name}.target_mm", f"must have {needed} places, one for each corner", len(target))
    chain = corners[[*edges, (edges[-1] + 1) % count]]
    return SupportCurve.through(chain, np.concatenate([target, target[:1]]) if is_closed else target)


def _selected(pins: Pins, corners: Floats, name: str, holes: Sequence[Floats]) -> tuple[Floats, tuple[int, ...]]:
    """Points (P, 2) and edges that an entry selects."""
    count = len(corners)
    if pins.where == "border":
        return _NO_POINTS, tuple(range(count))
    if pins.where == "corners":
        return corners[list(range(count))], ()
    if pins.corners is not None:
        return corners[list(_numbers(pins.corners, count, f"{name}.corners"))], ()
    if pins.edges is not None:
        return _NO_POINTS, _numbers(pins.edges, count, f"{name}.edges")
    if pins.holes is not None:
        sheet = SheetEdges.of(corners, holes)
        if not holes:
            raise DesignError(f"{name}.holes", "needs [[border.holes]]: the sheet has none", list(pins.holes))
        numbers = _numbers(pins.holes, len(holes), f"{name}.holes")
        return _NO_POINTS, tuple(edge for hole in numbers for edge in sheet.numbers(hole + 1).tolist())
    points = _snapped_to_outline(np.asarray(pins.points_mm), corners, f"{name}.points_mm")
    for hole in holes:
        points = _snapped_to_ring(points, hole, PIN_TOLERANCE_MM)
    return points, ()


def _numbers(numbers: tuple[int, ...], count: int, field: str) -> tuple[int, ...]:
    """Numbers of edges, corners or holes, if all exist and differ."""
    for k, number in enumerate(numbers):
        if not 0 <= number < count:
            raise DesignError(f"{field}[{k}]", f"must be from 0 to {count - 1}", number)
        if number in numbers[:k]:
            raise DesignError(f"{field}[{k}]", "must not be listed twice", number)
    return numbers


def _snapped_to_outline(points: Floats, corners: Floats, field: str) -> Floats:
    """Points (P, 2) on the sheet; those beside a corner or an edge, as written with few digits, are moved onto it.

    The space between a pin and the outline would be too narrow for good triangles.
    """
    tolerance = max(PIN_TOLERANCE_MM, 1e-6 * float(np.ptp(corners, axis=0).max()))
    places = shapely.points(points)
    off_sheet = shapely.distance(shapely.polygons(corners), places) > tolerance
    if off_sheet.any():
        k = int(off_sheet.argmax())
        raise DesignError(f"{field}[{k}]", "must be on the sheet", rounded_place(points[k]), place_mm=points[k])
    return _snapped_to_ring(points, corners, tolerance)


def _snapped_to_ring(points: Floats, corners: Floats, tolerance: float) -> Floats:
    """Points (P, 2); those within a tolerance (mm) of a corner or an edge of a ring (B, 2) are moved onto it."""
    places, ring = shapely.points(points), shapely.linearrings(corners)
    beside = shapely.distance(ring, places) <= tolerance
    feet = shapely.get_coordinates(shapely.line_interpolate_point(ring, shapely.line_locate_point(ring, places)))
    distance = np.linalg.norm(points[:, None] - corners, axis=2)
    corner = corners[distance.argmin(axis=1)]
    at_corner = distance.min(axis=1) <= tolerance
    return np.where(at_corner[:, None], corner, np.where(beside[:, None], feet, points))


def snapped_to_lines(pins: PinSet, corners: Floats, ends: Floats, lines: NDArray[np.object_]) -> PinSet:
    """The same pins; points beside an end of a line or beside a line are moved onto it, except those on the outline.

    Parameters
    ----------
    corners : (B, 2) mm, the outline.
    ends : (n, 2) mm, ends and corners of the lines.
    lines : of shapely, mm.
    """
    if not len(pins.points):
        return pins
    places = shapely.points(pins.points)
    inside = shapely.distance(shapely.linearrings(corners), places) > 1e-6 * float(np.ptp(corners, axis=0).max())
    end = ends[shapely.STRtree(shapely.points(ends)).nearest(places)]
    at_end = np.linalg.norm(pins.points - end, axis=1) <= PIN_TOLERANCE_MM
    line = lines[shapely.STRtree(lines).nearest(places)]
    foot = shapely.get_coordinates(shapely.line_interpolate_point(line, shapely.line_locate_point(line, places)))
    beside = inside & (shapely.distance(line, places) <= PIN_TOLERANCE_MM)
    if not beside.any():
        return pins
    on_line = np.where(at_end[:, None], end, foot)
    return replace(pins, points=np.where(beside[:, None], on_line, pins.points))


def rounded_place(point: Floats) -> list[float]:
    """A place as messages show it."""
    return [round(float(c), 4) for c in point]
