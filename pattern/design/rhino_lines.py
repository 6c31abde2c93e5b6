"""The curves of a 3DM file as lines on the print."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.rhino_model import RhinoModel
from asterism.pattern.geometry.flattening import flattened

# points of a curve in each span between its knots, at which its turn is measured
SPAN_SAMPLES = 24


def rhino_lines(model: RhinoModel, curve_mm: float) -> list[tuple[Floats, str]]:
    """Points (n, 2) mm and the layer of each visible curve, seen from above.

    The last point of a closed curve is its first. Curves within blocks are left out.

    Parameters
    ----------
    curve_mm : largest distance of a curve from the polyline that stands for it.
    """
    lines = []
    for geometry, layer in model.visible():
        pieces = list(_pieces(geometry, curve_mm / model.mm))
        if pieces:
            points = model.mm * np.concatenate(pieces)
            closed = [points[:1]] if geometry.IsClosed else []
            lines.append((np.concatenate([points, *closed]), layer))
    return lines


def _pieces(geometry: Any, tolerance: float) -> Iterator[Floats]:
    """Points (n, 2) along the parts of a curve, in the unit of the file; nothing for surfaces, points and texts."""
    import rhino3dm

    if isinstance(geometry, rhino3dm.PolylineCurve):
        yield _places([geometry.Point(number) for number in range(geometry.PointCount)])
    elif isinstance(geometry, rhino3dm.LineCurve):
        yield _places([geometry.PointAtStart, geometry.PointAtEnd])
    elif isinstance(geometry, rhino3dm.PolyCurve):
        for number in range(geometry.SegmentCount):
            yield from _pieces(geometry.SegmentCurve(number), tolerance)
    elif isinstance(geometry, rhino3dm.NurbsCurve):
        # a curve may have corners at its knots
        table: Any = geometry.Knots
        knots = np.unique([table[number] for number in range(len(table))])
        inside = knots[(knots >= geometry.Domain.T0) & (knots <= geometry.Domain.T1)]
        for start, end in pairwise(inside):
            yield _flat(geometry, float(start), float(end), tolerance)
    elif isinstance(geometry, rhino3dm.Curve):
        yield _flat(geometry, geometry.Domain.T0, geometry.Domain.T1, tolerance)


def _flat(curve: Any, start: float, end: float, tolerance: float) -> Floats:
    def places(at: Floats) -> Floats:
        return _places(list(map(partial(_point, curve), at)))

    return flattened(places, np.linspace(start, end, SPAN_SAMPLES + 1), tolerance)


def _point(curve: Any, at: float) -> Any:
    return curve.PointAt(float(at))


def _places(points: list[Any]) -> Floats:
    return np.array([(point.X, point.Y) for point in points], dtype=float).reshape(-1, 2)
