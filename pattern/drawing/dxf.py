"""Lines of DXF, by `ezdxf` (the extra `cad`)."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.drawing.records import MAX_DEPTH, MAX_ELEMENTS, DrawingError, FileLine, Source, checked
from asterism.pattern.geometry.flattening import flattened

DXF_NEEDED = 'needs ezdxf: pip install "asterism-fabric[cad]"'
_LINES = ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "HELIX")
_NAMES = {"MTEXT": "text|s", "TEXT": "text|s", "ATTRIB": "text|s", "ATTDEF": "text|s", "HATCH": "hatch|es"}
_STARTS = {b"AutoCAD Binary DXF": "binary DXF", b"AC10": "DWG", b"<": "HTML or XML"}
# mm of the unit by its number in the header, $INSUNITS; 0 is none
_MM_OF_INSUNITS = {1: 25.4, 2: 304.8, 3: 1_609_344.0, 4: 1.0, 5: 10.0, 6: 1e3, 7: 1e6, 8: 2.54e-5, 9: 0.0254, 10: 914.4}
_MM_OF_INSUNITS |= {11: 1e-7, 12: 1e-6, 13: 1e-3, 14: 100.0, 15: 1e4, 16: 1e5, 21: 1.2e6 / 3937.0}
# pieces of a Bezier curve: a quarter of a circle turns by less than 6 degrees in each
_CURVE_PIECES = 16
# points of a spline in each span between its knots, at which its turn is measured
_SPAN_SAMPLES = 24


def open_dxf(path: Path) -> Source:
    """The drawing in the model space of a DXF file."""
    try:
        from ezdxf import recover
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise DrawingError(DXF_NEEDED) from None
    raw = path.read_bytes()
    kind = next((kind for start, kind in _STARTS.items() if raw.lstrip().startswith(start)), None)
    if kind or b"SECTION" not in raw:
        raise DrawingError(f"cannot be read as DXF, it is {kind or 'no drawing'}: save the drawing as text DXF")
    try:
        drawing, _ = recover.readfile(path)
    except (DXFError, OSError, ValueError, IndexError, KeyError, RecursionError) as error:
        raise DrawingError(f"cannot be read as DXF: {type(error).__name__}") from None
    _unfold_arrays(drawing)
    number = int(drawing.header.get("$INSUNITS", 0))
    known = "no" if number == 0 else "an unknown"
    problem = f"has {known} unit ($INSUNITS = {number}): set it to mm in the drawing"
    return Source(_MM_OF_INSUNITS.get(number), problem, number == 0, partial(_lines, drawing))


def _lines(drawing: Any, curve: float, left_out: Counter[str]) -> Iterator[FileLine]:
    from ezdxf.path import make_path

    for entity, layer in _entities(drawing.modelspace(), drawing.layers, ("0", False), 0, itertools.count(), left_out):
        name = f"{entity.dxftype()} {entity.dxf.get('handle') or 'in a block'}"
        if entity.dxftype() in ("SPLINE", "HELIX") and not _is_bezier(tool := entity.construction_tool()):
            points = _spline_points(tool, curve, layer, name)
        else:
            outline = make_path(entity)
            if len(outline) == 0:
                continue
            checked(np.array([point.xyz for point in outline.control_vertices()]), layer, name)
            flat = outline.flattening(curve, segments=_CURVE_PIECES)
            points = np.array([(p.x, p.y) for p in flat], dtype=float).reshape(-1, 2)
        width = float(entity.dxf.get("const_width", 0.0)) if entity.dxftype() == "LWPOLYLINE" else 0.0
        yield FileLine(points, layer, width or None, name)


def _entities(
    entities: Iterable[Any], layers: Any, outer: tuple[str, bool], depth: int, count: Iterator[int], left_out: Any
) -> Iterator[tuple[Any, str]]:
    """The visible lines with the names of their layers, also those in blocks.

    Parameters
    ----------
    outer : layer of the insert around, which layer 0 of a block stands for, and whether the insert is hidden.
    """
    if depth > MAX_DEPTH:
        raise DrawingError(f"has blocks more than {MAX_DEPTH} deep, or one that holds itself")
    for entity in entities:
        if next(count) > MAX_ELEMENTS:
            raise DrawingError(f"holds more than {MAX_ELEMENTS} entities, counted in all copies of its blocks")
        kind = entity.dxftype()
        layer = outer[0] if str(entity.dxf.layer) == "0" else str(entity.dxf.layer)
        entry = layers.get(layer) if layers.has_entry(layer) else None
        is_frozen = outer[1] or (entry is not None and entry.is_frozen())
        is_hidden = bool(entity.dxf.get("invisible", 0))
        if kind == "INSERT":
            parts = entity.virtual_entities(skipped_entity_callback=partial(_skip, left_out))
            yield from _entities(parts, layers, (layer, is_frozen or is_hidden), depth + 1, count, left_out)
        elif kind not in _LINES or (kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
            left_out[_NAMES.get(kind, f"{kind}|s" if kind not in _LINES else "mesh|es")] += 1
        elif is_frozen or (entry is not None and entry.is_off()):
            left_out["line|s in hidden layers"] += 1
        elif is_hidden:
            left_out["hidden line|s"] += 1
        else:
            yield entity, layer


def _unfold_arrays(drawing: Any) -> None:
    """Single inserts in place of arrays of them: ezdxf does not turn and scale the steps of an array within a block."""
    arrays = [(block, one) for block in drawing.blocks for one in block.query("INSERT") if one.mcount > 1]
    if (count := sum(array.mcount for _, array in arrays)) > MAX_ELEMENTS:
        raise DrawingError(f"holds arrays of {count} blocks, at most {MAX_ELEMENTS} are allowed")
    for block, array in arrays:
        for one in array.multi_insert():
            drawing.entitydb.add(one)
            block.add_entity(one)
        block.delete_entity(array)


def _skip(left_out: Counter[str], entity: Any, reason: str) -> None:
    left_out[f"{entity.dxftype()}|s in blocks that are scaled unevenly"] += 1


def _is_bezier(spline: Any) -> bool:
    return spline.degree == 3 and not spline.is_rational and spline.is_clamped


def _spline_points(spline: Any, curve: float, layer: str, name: str) -> Floats:
    """(n, 2) points along a spline of any degree, with weights, over its domain."""
    from scipy.interpolate import BSpline

    places = np.array([point.xyz for point in spline.control_points])
    knots, degree = np.array(spline.knots()), spline.degree
    weights = np.array(spline.weights() or np.ones(len(places)))[:, None]
    checked(np.column_stack([places, weights]), layer, name)
    function = BSpline(knots, np.column_stack([places[:, :2] * weights, weights]), degree)
    spans = np.unique(knots[degree : len(knots) - degree])
    samples = np.interp(np.linspace(0, len(spans) - 1, _SPAN_SAMPLES * (len(spans) - 1) + 1), range(len(spans)), spans)

    def at(parameters: Floats) -> Floats:
        value = function(parameters)
        return np.asarray(value[:, :2] / value[:, 2:])

    return flattened(at, samples, curve)
