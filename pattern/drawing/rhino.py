"""3DM files of Rhino, opened by `rhino3dm` (the extra `cad`): for lines of a design, and for targets of a fit."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.drawing.records import MAX_DEPTH, MAX_ELEMENTS, DrawingError, FileLine, Source, checked
from asterism.pattern.geometry.flattening import flattened_spline

RHINO_FORMAT = ".3dm"
RHINO_NEEDED = 'needs rhino3dm: pip install "asterism-fabric[cad]"'
# larger files are refused
MAX_RHINO_BYTES = 200_000_000
# mm, by the names of `rhino3dm.UnitSystem`
RHINO_UNITS_MM = {
    "Microns": 1e-3,
    "Millimeters": 1.0,
    "Centimeters": 10.0,
    "Decimeters": 100.0,
    "Meters": 1000.0,
    "Inches": 25.4,
    "Feet": 304.8,
    "Yards": 914.4,
    "None": 1.0,
    "Unset": 1.0,
}


@dataclass(frozen=True)
class RhinoModel:
    """An open 3DM file."""

    file: Any  # the `rhino3dm.File3dm`
    mm: float  # length of its unit

    def shown(self, objects: Iterable[Any] | None = None) -> Iterator[tuple[Any, str, str]]:
        """The geometry of some objects, or of all outside blocks.

        Each with the full name of its layer, as `sheet::outline`, and the reason why it is hidden.
        """
        if objects is None:
            objects = [thing for thing in self.file.Objects if not thing.Attributes.IsInstanceDefinitionObject]
        for thing in objects:
            number, hidden = thing.Attributes.LayerIndex, ""
            layer = self.file.Layers.FindIndex(number) if 0 <= number < len(self.file.Layers) else None
            name, above = "" if layer is None else layer.FullPath, layer
            while above is not None:
                hidden = hidden or ("" if above.Visible else "line|s in hidden layers")
                above = self.file.Layers.FindId(above.ParentLayerId) if "::" in above.FullPath else None
            yield thing.Geometry, name, hidden or ("" if thing.Attributes.Visible else "hidden line|s")

    def unfolded(
        self, number: Iterator[int], objects: Iterable[Any] | None = None, depth: int = 0
    ) -> Iterator[tuple[Any, str, str]]:
        """What `shown` gives, with the parts of blocks in place of the blocks; `number` counts the objects.

        Raises `DrawingError` if a block holds itself, or copies are too many.
        """
        import rhino3dm

        if depth > MAX_DEPTH:
            raise DrawingError(f"has blocks more than {MAX_DEPTH} deep, or one that holds itself")
        for geometry, layer, hidden in self.shown(objects):
            if next(number) > MAX_ELEMENTS:
                raise DrawingError(f"holds more than {MAX_ELEMENTS} objects, counted in all copies of its blocks")
            if not isinstance(geometry, rhino3dm.InstanceReference):
                yield geometry, layer, hidden
                continue
            insert: Any = geometry
            block = self.file.InstanceDefinitions.FindId(insert.ParentIdefId)
            parts = [] if block is None else filter(None, map(self.file.Objects.FindId, block.GetObjectIds()))
            for part, own, is_hidden in self.unfolded(number, parts, depth + 1):
                # circles cannot be stretched
                copy = part.ToNurbsCurve() if isinstance(part, rhino3dm.Curve) else part.Duplicate()
                copy.Transform(insert.Xform)
                yield copy, own, hidden or is_hidden


def open_rhino_model(path: Path, mm: float | None, error: Callable[[str], Exception]) -> RhinoModel:
    """Open a 3DM file.

    Parameters
    ----------
    mm : length of the unit of the numbers; None for the unit that the file names.
    error : makes the error that is raised from what is wrong with the file.
    """
    if not path.is_file():
        raise error("is no file" if path.exists() else "is not there")
    if path.stat().st_size > MAX_RHINO_BYTES:
        raise error(f"is larger than {MAX_RHINO_BYTES // 1_000_000} MB")
    try:
        import rhino3dm
    except ImportError:
        raise error(f"reading 3DM {RHINO_NEEDED}") from None
    file: Any
    try:
        file = rhino3dm.File3dm.Read(str(path))
    except Exception:  # errors of the binding have no common class
        file = None
    if file is None:
        raise error("cannot be read as 3DM: the file is damaged or cut short")
    unit = file.Settings.ModelUnitSystem.name
    if mm is None and unit not in RHINO_UNITS_MM:
        raise error(f"its unit is {unit}: save it in mm, or give the unit of its numbers")
    return RhinoModel(file, RHINO_UNITS_MM[unit] if mm is None else mm)


def open_rhino_drawing(path: Path, unit_mm: float | None) -> Source:
    """The curves of a 3DM file, seen from above."""
    model = open_rhino_model(path, unit_mm, DrawingError)
    return Source(model.mm, "", False, partial(_lines, model))


def _lines(model: RhinoModel, curve: float, left_out: Counter[str]) -> Iterator[FileLine]:
    import rhino3dm

    for geometry, layer, hidden in model.unfolded(count()):
        name = type(geometry).__name__
        if hidden or not isinstance(geometry, rhino3dm.Curve):
            left_out[hidden or f"{name}|s"] += 1
        else:
            points = curve_points(geometry, curve, layer)
            if len(points):
                yield FileLine(points, layer, None, name)


def curve_points(geometry: Any, tolerance: float, layer: str = "") -> Floats:
    """Points (n, 2) along a curve of `rhino3dm`, seen from above; a closed one returns to its first point.

    Raises `DrawingError` if a point is not finite, or too far away.

    Parameters
    ----------
    tolerance : largest distance of the curve from the lines between them, in its unit.
    layer : for the error.
    """
    pieces = [checked(piece, layer, type(geometry).__name__) for piece in _pieces(geometry, tolerance)]
    if not pieces:
        return np.empty((0, 2))
    return np.concatenate([*pieces, pieces[0][:1]] if geometry.IsClosed else pieces)


def _pieces(geometry: Any, tolerance: float) -> Iterator[Floats]:
    """Points (n, 2) along the parts of a curve, in the unit of the file."""
    import rhino3dm

    if isinstance(geometry, rhino3dm.PolylineCurve):
        yield _places([geometry.Point(number) for number in range(geometry.PointCount)])
    elif isinstance(geometry, rhino3dm.LineCurve):
        yield _places([geometry.PointAtStart, geometry.PointAtEnd])
    elif isinstance(geometry, rhino3dm.PolyCurve):
        for number in range(geometry.SegmentCount):
            yield from _pieces(geometry.SegmentCurve(number), tolerance)
    else:
        ends = [geometry.Domain.T0, geometry.Domain.T1]
        if isinstance(geometry, rhino3dm.NurbsCurve):
            # a curve may have corners at its knots
            table: Any = geometry.Knots
            knots = np.unique([table[number] for number in range(len(table))])
            ends = [float(knot) for knot in knots[(knots >= ends[0]) & (knots <= ends[1])]]
        if len(ends) > 1:
            yield flattened_spline(partial(_along, geometry), np.array(ends), tolerance)


def _along(curve: Any, parameters: Floats) -> Floats:
    return checked(_places([curve.PointAt(float(at)) for at in parameters]), "", type(curve).__name__)


def _places(points: list[Any]) -> Floats:
    return np.array([(point.X, point.Y) for point in points], dtype=float).reshape(-1, 2)
