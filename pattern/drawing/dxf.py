"""Lines of DXF, by `ezdxf` (the extra `cad`)."""

from __future__ import annotations

import itertools
import logging
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.drawing.records import MAX_DEPTH, MAX_ELEMENTS, DrawingError, FileLine, Source, checked
from asterism.pattern.geometry.flattening import flattened_spline

DXF_NEEDED = 'needs ezdxf: pip install "asterism-fabric[cad]"'
_LINES = ("LINE", "LWPOLYLINE", "POLYLINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "HELIX")
_NAMES = {"MTEXT": "text|s", "TEXT": "text|s", "ATTRIB": "text|s", "ATTDEF": "text|s", "HATCH": "hatch|es"}
# mm of the unit by its number in the header, $INSUNITS; 0 is none
_MM_OF_INSUNITS = {1: 25.4, 2: 304.8, 3: 1_609_344.0, 4: 1.0, 5: 10.0, 6: 1e3, 7: 1e6, 8: 2.54e-5, 9: 0.0254, 10: 914.4}
_MM_OF_INSUNITS |= {11: 1e-7, 12: 1e-6, 13: 1e-3, 14: 100.0, 15: 1e4, 16: 1e5, 21: 1.2e6 / 3937.0}


def open_dxf(path: Path) -> Source:
    """The drawing in the model space of a DXF file."""
    try:
        from ezdxf import recover
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise DrawingError(DXF_NEEDED) from None
    raw = path.read_bytes()
    starts = {b"AutoCAD Binary DXF": "binary DXF", b"AC10": "DWG", b"<": "HTML or XML"}
    kind = next((kind for start, kind in starts.items() if raw.lstrip().startswith(start)), None)
    if kind or b"SECTION" not in raw:
        raise DrawingError(f"cannot be read as DXF, it is {kind or 'no drawing'}: save the drawing as text DXF")
    logging.getLogger("ezdxf").setLevel(logging.CRITICAL)
    try:
        drawing, audit = recover.read(BytesIO(_with_own_handles(raw)))
        number = drawing.header.get("$INSUNITS", 0)
    except (DXFError, OSError, ArithmeticError, ValueError, LookupError, TypeError, RecursionError) as error:
        raise DrawingError(f"cannot be read as DXF: {type(error).__name__}") from None
    # such as inserts of blocks that are missing, and the end of a file
    deleted = sum(fix.message.startswith("Deleted entity") for fix in audit.fixes) + (b"EOF" not in raw)
    known = "no" if number == 0 else "an unknown"
    problem = f"has {known} unit ($INSUNITS = {number}): set it to mm in the drawing"
    return Source(_MM_OF_INSUNITS.get(number), problem, number == 0, partial(_lines, drawing, deleted))


def _with_own_handles(raw: bytes) -> bytes:
    """The text of a drawing in which no two entities have one handle: ezdxf keeps one entity a handle."""
    lines = raw.splitlines()
    seen = set[bytes]()
    for k in range(0, len(lines) - 1, 2):
        if lines[k].strip() == b"5":
            if lines[k + 1].strip().upper() in seen:
                # handles from this number on are in no drawing
                lines[k + 1] = b"%X" % (0x7000000000 + k)
            seen.add(lines[k + 1].strip().upper())
    return b"\n".join([*lines, b""])


def _lines(drawing: Any, deleted: int, curve: float, left_out: Counter[str]) -> Iterator[FileLine]:
    from ezdxf.math import Matrix44
    from ezdxf.path import make_path

    left_out["damaged part|s"] += deleted
    sheets = (entity for sheet in drawing.layouts if sheet.is_any_paperspace for entity in sheet)
    left_out["object|s in paper space"] += sum(entity.dxftype() in (*_LINES, "INSERT") for entity in sheets)
    found = _entities(drawing.modelspace(), drawing.layers, ("0", False), Matrix44(), 0, itertools.count(), left_out)
    for entity, layer, matrix in found:
        kind = entity.dxftype()
        name = f"{kind} {entity.dxf.get('handle') or 'in a block'}"
        try:
            if kind in ("SPLINE", "HELIX"):
                points = _spline_points(entity.construction_tool(), matrix, curve, layer, name)
            else:
                # 16 Bezier curves of a circle are within 1e-7 of its radius; 4 pieces of each turn by less than 6 deg
                outline = make_path(entity, segments=16).transform(matrix)
                checked(np.array([point.xyz for point in outline.control_vertices()]), layer, name)
                points = np.array([(p.x, p.y) for p in outline.flattening(curve, segments=4)], dtype=float)
        except (ArithmeticError, ValueError) as error:
            if isinstance(error, DrawingError):
                raise
            raise DrawingError(f"holds what is no line: {name} in layer {layer!r}") from None
        width = float(entity.dxf.get("const_width", 0.0)) if kind == "LWPOLYLINE" else 0.0
        scale = float(np.sqrt(abs(np.linalg.det(np.array(matrix.get_2d_transformation()).reshape(3, 3)))))
        yield FileLine(points.reshape(-1, 2), layer, scale * width or None, name)


def _entities(
    entities: Iterable[Any],
    layers: Any,
    outer: tuple[str, bool],
    matrix: Any,
    depth: int,
    count: Iterator[int],
    left_out: Counter[str],
) -> Iterator[tuple[Any, str, Any]]:
    """The visible lines, also those in blocks, with the names of their layers and the matrices that place them.

    `outer`: layer of the insert around, which layer 0 of a block stands for, and whether the insert is hidden.
    """
    if depth > MAX_DEPTH:
        raise DrawingError(f"has blocks more than {MAX_DEPTH} deep, or one that holds itself")
    for entity in entities:
        kind, layer = entity.dxftype(), str(entity.dxf.layer)
        if layer == "0":
            layer = outer[0]
        is_frozen, is_hidden, is_off = outer[1], bool(entity.dxf.get("invisible", 0)), False
        if layers.has_entry(layer):
            entry = layers.get(layer)
            # names differ by more than case
            layer, is_off = str(entry.dxf.name), entry.is_off()
            is_frozen = is_frozen or entry.is_frozen()
        for one in entity.multi_insert() if kind == "INSERT" else (entity,):
            if next(count) > MAX_ELEMENTS:
                raise DrawingError(f"holds more than {MAX_ELEMENTS} entities, counted in all copies of its blocks")
            if kind == "INSERT" and (block := one.block()) is not None:
                left_out["external reference|s"] += block.block.is_xref
                around, placed = (layer, is_frozen or is_hidden), one.matrix44() @ matrix
                yield from _entities(block, layers, around, placed, depth + 1, count, left_out)
            elif kind not in _LINES or (kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline)):
                left_out[_NAMES.get(kind, f"{kind}|s" if kind not in _LINES else "mesh|es")] += 1
            elif is_frozen or is_off:
                left_out["line|s in hidden layers"] += 1
            elif is_hidden:
                left_out["hidden line|s"] += 1
            else:
                yield entity, layer, matrix


def _spline_points(spline: Any, matrix: Any, curve: float, layer: str, name: str) -> Floats:
    """(n, 2) points along a spline of any degree, with weights, over its domain."""
    from scipy.interpolate import BSpline

    places = np.array([point.xyz for point in matrix.transform_vertices(spline.control_points)])
    knots, degree = np.array(spline.knots()), spline.degree
    weights = np.array(spline.weights() or np.ones(len(places)))[:, None]
    checked(np.column_stack([places, weights]), layer, name)
    function = BSpline(knots, np.column_stack([places[:, :2] * weights, weights]), degree)

    def at(parameters: Floats) -> Floats:
        value = function(parameters)
        return np.asarray(value[:, :2] / value[:, 2:])

    return flattened_spline(at, np.unique(knots[degree : len(knots) - degree]), curve)
