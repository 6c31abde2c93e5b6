"""Lines in drawings of other programs, SVG, DXF and 3DM, in mm with y upwards."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError, NoUnitError
from asterism.pattern.design.rhino_model import RHINO_FORMAT, RhinoModel, open_rhino_model
from asterism.pattern.geometry.flattening import flattened

MAX_FILE_BYTES = 20_000_000
MAX_FILE_LINES = 20_000
MM_OF_UNITS = {"mm": 1.0, "cm": 10.0, "in": 25.4, "px": 25.4 / 96.0}
# mm of a DXF drawing's unit by its number in the header, $INSUNITS; 0 is none
MM_OF_INSUNITS = {1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0, 14: 100.0}
DXF_LINES = "LINE LWPOLYLINE POLYLINE ARC CIRCLE ELLIPSE SPLINE INSERT"
# points of a curve in SVG at which its turn is measured
CURVE_SAMPLES = 64
# pieces of a curve in DXF: a quarter of a circle turns by less than 6 degrees in each
DXF_CURVE_PIECES = 16
# a stroke is stretched unevenly if its widths along x and y differ by more than this part
MAX_STROKE_UNEVENNESS = 0.02
MAX_PLACE_MM = 1e5
SAME_PLACE_MM = 1e-4
# programs round coordinates: a line whose ends are this close is closed
CLOSED_GAP_MM = 1e-3
DXF_NEEDED = 'needs ezdxf: pip install "asterism-fabric[cad]"'
_SVG = "{http://www.w3.org/2000/svg}"
_LAYER_NAME = "{http://www.inkscape.org/namespaces/inkscape}label"
_LAYER = "data-asterism-layer"
_INVISIBLE_TAGS = ("marker", "mask", "clipPath", "pattern", "symbol")
# points of a curve in each span between its knots, at which its turn is measured
SPAN_SAMPLES = 24


@dataclass(frozen=True)
class FileLine:
    """One line of a drawing.

    Attributes
    ----------
    points : (n, 2) mm; the last is the first if it is closed.
    layer : name of its layer: in SVG of the group around it, or the colour of its stroke.
    width_mm : of its stroke, or of the polyline in DXF; None if the file gives none.
    """

    points: Floats
    layer: str
    width_mm: float | None


def read_lines(path: Path, curve_mm: float, units: str | None) -> list[FileLine]:
    """All visible lines of a drawing.

    Parameters
    ----------
    path : file that ends in .svg, .dxf or .3dm.
    curve_mm : largest distance of a curve from the polyline that stands for it.
    units : unit of a file that gives none; a key of `MM_OF_UNITS`.

    Raises
    ------
    DesignError
        The file cannot be read, or holds no line.
    NoUnitError
        The file has no unit, and none is given.
    """
    if not path.is_file():
        raise _error(f"there is no such file in {path.parent.absolute()}", path)
    if path.stat().st_size > MAX_FILE_BYTES:
        raise _error(f"must be at most {MAX_FILE_BYTES // 1_000_000} MB", path)
    readers = {".svg": _svg_lines, ".dxf": _dxf_lines, RHINO_FORMAT: _rhino_lines}
    if (reader := readers.get(path.suffix.lower())) is None:
        raise _error("must end in .svg, .dxf or .3dm", path)
    lines = [replace(line, points=_cleaned(line.points)) for line in reader(path, curve_mm, units)]
    lines = [line for line in lines if len(line.points) > 1]
    if not lines:
        raise _error("holds no line with a stroke", path)
    if len(lines) > MAX_FILE_LINES:
        raise _error(f"holds {len(lines)} lines, at most {MAX_FILE_LINES} are allowed", path)
    farthest = max(float(np.abs(line.points).max()) for line in lines)
    if not farthest <= MAX_PLACE_MM:
        raise _error("holds places that are not finite, or further than 100 m from the origin", path)
    return lines


def closed_lines(lines: list[FileLine], layer: Any, file: str) -> list[FileLine]:
    """The closed lines of a drawing on a layer, or on all layers if it is None.

    Raises
    ------
    DesignError
        There are none.
    """
    closed = [line for line in lines if len(line.points) > 3 and np.array_equal(line.points[0], line.points[-1])]
    chosen = [line for line in closed if layer is None or line.layer == layer]
    if not chosen:
        known = ", ".join(sorted({line.layer for line in closed})) or "none"
        field, value = ("file", file) if layer is None else ("layer", layer)
        raise DesignError(field, f"must have a closed line; layers with one: {known}", value)
    return chosen


def _svg_lines(path: Path, curve_mm: float, units: str | None) -> list[FileLine]:
    import svgelements as svg  # slow to import, rarely used

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            root = ElementTree.fromstring(path.read_bytes())
            _mark_layers(root, "")
            drawing = svg.SVG.parse(BytesIO(ElementTree.tostring(root)), reify=False, ppi=96)
            shapes = list(drawing.elements(lambda element: isinstance(element, svg.Shape)))
    except Exception as error:  # svgelements raises errors of many kinds on damaged files
        raise _error(
            f"cannot be read as SVG: {str(error).splitlines()[0] if str(error) else type(error).__name__}", path
        ) from None
    measured = all(
        str(root.get(side, "")).strip().lower().endswith(("mm", "cm", "in", "pt", "pc")) for side in ("width", "height")
    )
    if not measured and units is None:
        raise NoUnitError("file", 'has no size in mm: give it one in the drawing, or units = "mm" here', path.name)
    scale = MM_OF_UNITS["px"] if measured else MM_OF_UNITS[units or "mm"]
    lines = []
    for shape in shapes:
        if (
            shape.stroke is None
            or shape.stroke.value is None
            or shape.values.get("visibility") in ("hidden", "collapse")
        ):
            continue
        width = _stroke_width(shape, scale, path)
        layer = shape.values.get(_LAYER) or str(shape.stroke.hex)
        for part in abs(svg.Path(shape)).as_subpaths():
            points = _svg_points(svg.Path(part), curve_mm / scale)
            if len(points) > 1:
                lines.append(FileLine(points * [scale, -scale], str(layer), width))
    return lines


def _mark_layers(element: Any, layer: str) -> None:
    """Write the name of its layer to every element, and take out what is not part of the drawing."""
    for child in list(element):
        tag = str(child.tag).removeprefix(_SVG)
        if tag in _INVISIBLE_TAGS:
            element.remove(child)
            continue
        name = (child.get(_LAYER_NAME) or child.get("id") or layer) if tag == "g" else layer
        if name:
            child.set(_LAYER, name)
        _mark_layers(child, name)


def _stroke_width(shape: Any, scale: float, path: Path) -> float:
    """mm, after all transforms."""
    m = shape.transform
    sizes = np.linalg.svd(np.array([[m.a, m.c], [m.b, m.d]]), compute_uv=False)
    if sizes[0] > (1.0 + MAX_STROKE_UNEVENNESS) * sizes[1]:
        name = shape.id or type(shape).__name__
        ratio = sizes[0] / max(sizes[1], 1e-12)
        raise _error(f"{name} is drawn with a stroke stretched {ratio:.2g} to 1: remove the transform", path)
    return float(scale * np.sqrt(sizes[0] * sizes[1]) * shape.stroke_width)


def _svg_points(part: Any, tolerance: float) -> Floats:
    """(n, 2) points along one path."""
    import svgelements as svg

    pieces: list[Floats] = []
    for piece in part:
        if isinstance(piece, svg.Move):
            continue
        if isinstance(piece, svg.Line | svg.Close):
            ends = [piece.start, piece.end]
            points = np.array([(p.x, p.y) for p in ends if p is not None], dtype=float)
        else:
            points = flattened(partial(_places, piece), np.linspace(0.0, 1.0, CURVE_SAMPLES + 1), tolerance)
        pieces.append(points)
    return np.concatenate(pieces) if pieces else np.empty((0, 2))


def _places(piece: Any, at: Floats) -> Floats:
    """(k, 2) points of a piece of a path at parameters (k,)."""
    return np.array([(p.x, p.y) for p in map(piece.point, at)], dtype=float)


def _dxf_lines(path: Path, curve_mm: float, units: str | None) -> list[FileLine]:
    try:
        from ezdxf import recover
        from ezdxf.lldxf.const import DXFError
        from ezdxf.path import make_path
    except ImportError:
        raise _error(DXF_NEEDED, path) from None
    try:
        drawing, _ = recover.readfile(path)
    except (DXFError, OSError, ValueError, IndexError, KeyError) as error:
        raise _error(f"cannot be read as DXF: {type(error).__name__}", path) from None
    number = int(drawing.header.get("$INSUNITS", 0))
    if number not in MM_OF_INSUNITS and (units is None or number != 0):
        problem = "has no unit ($INSUNITS = 0)" if number == 0 else f"has another unit ($INSUNITS = {number})"
        kind = NoUnitError if number == 0 else DesignError
        raise kind("file", f'{problem}: set it to mm in the drawing, or units = "mm" here', path.name)
    scale = MM_OF_INSUNITS.get(number) or MM_OF_UNITS[units or "mm"]
    lines = []
    for entity in _entities(drawing.modelspace()):
        flat = make_path(entity).flattening(curve_mm / scale, segments=DXF_CURVE_PIECES)
        points = np.array([(p.x, p.y) for p in flat], dtype=float).reshape(-1, 2)
        width = float(entity.dxf.get("const_width", 0.0)) if entity.dxftype() == "LWPOLYLINE" else 0.0
        if len(points) > 1:
            lines.append(FileLine(points * scale, str(entity.dxf.layer), width * scale or None))
    return lines


def _rhino_lines(path: Path, curve_mm: float, units: str | None) -> list[FileLine]:
    model = open_rhino_model(path, MM_OF_UNITS[units] if units else None, lambda problem: _error(problem, path))
    return [FileLine(points, layer, None) for points, layer in rhino_lines(model, curve_mm)]


def _entities(space: Any) -> list[Any]:
    """The lines of a drawing, with those of its blocks."""
    entities: list[Any] = []
    for entity in space.query(DXF_LINES):
        if entity.dxftype() != "INSERT":
            entities.append(entity)
        else:
            inner = entity.virtual_entities()
            entities += [part for part in inner if part.dxftype() in DXF_LINES.split() and part.dxftype() != "INSERT"]
    return entities


def _cleaned(points: Floats) -> Floats:
    """The points without those that repeat the one before; a line that returns to its start ends with it exactly."""
    kept = points[:1]
    if len(points) > 1:
        step = np.linalg.norm(np.diff(points, axis=0), axis=1)
        kept = points[np.concatenate([[True], step > SAME_PLACE_MM])]
    if len(kept) > 3 and np.linalg.norm(kept[0] - kept[-1]) <= CLOSED_GAP_MM:
        kept[-1] = kept[0]
    return kept


def _error(problem: str, path: Path) -> DesignError:
    return DesignError("file", problem, path.name)


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
        yield _curve_places([geometry.Point(number) for number in range(geometry.PointCount)])
    elif isinstance(geometry, rhino3dm.LineCurve):
        yield _curve_places([geometry.PointAtStart, geometry.PointAtEnd])
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
        return _curve_places(list(map(partial(_point, curve), at)))

    return flattened(places, np.linspace(start, end, SPAN_SAMPLES + 1), tolerance)


def _point(curve: Any, at: float) -> Any:
    return curve.PointAt(float(at))


def _curve_places(points: list[Any]) -> Floats:
    return np.array([(point.X, point.Y) for point in points], dtype=float).reshape(-1, 2)
