"""Drawings that a design names: read once, and their lines stored in its tables."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.drawing.read import Drawing, box_middle, closed_curves, read_drawing
from asterism.pattern.drawing.records import MM_OF_UNITS, DrawingError, FileLine

# mm, largest distance of an imported curve from the straight pieces that are stored
IMPORT_CURVE_MM = 0.005
# and of the outline from the straight edges of the sheet
OUTLINE_CURVE_MM = 0.02


def with_drawings(data: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """The tables of a design, with the lines of the files that they name and do not hold yet.

    All that comes from one file, and has the origin `middle`, is shifted alike: the middle of the outline, else that of
    the box around all chosen layers, becomes the origin. Raises `DesignError` if a file cannot be read, or its closed
    lines are not one outline with holes.
    """
    data = dict(data)
    tables = _tables(data)
    drawings: dict[tuple[Path, float, Any], Drawing] = {}
    outline: dict[Path, Floats] = {}
    chosen: dict[Path, list[FileLine]] = {}
    read = []
    for place, table, stored in tables:
        if not isinstance(table.get("file"), str) or table.get(stored):
            continue
        path, units = folder / table["file"], table.get("units")
        mm = MM_OF_UNITS.get(units) if isinstance(units, str) else None
        key = (Path(os.path.abspath(path)), OUTLINE_CURVE_MM if place == "border" else IMPORT_CURVE_MM, mm)
        try:
            drawings[key] = drawings.get(key) or read_drawing(path, *key[1:])
        except DrawingError as error:
            raise DesignError(f"{place}.file", str(error), path.name) from None
        drawing = drawings[key]
        rings = [] if stored == "lines" else _rings(place, table, drawing)
        is_moved = table.get("origin", "middle") == "middle"
        if place == "border" and is_moved:
            outline[key[0]] = np.array([rings[0].min(axis=0), rings[0].max(axis=0)]).mean(axis=0)
        elif is_moved:
            layers = table.get("layers" if stored == "lines" else "layer")
            layers = [layers] if isinstance(layers, str) else layers if isinstance(layers, dict) else drawing.layers
            chosen.setdefault(key[0], []).extend(drawing.lines_of(layers))
        read.append((place, table, stored, key[0] if is_moved else None, drawing, rings))
    middles = {path: box_middle(those) for path, those in chosen.items() if those} | outline
    for place, table, stored, moved, drawing, rings in read:
        shift = middles.get(moved, np.zeros(2)) if moved else np.zeros(2)
        if stored == "lines":
            layers = table.get("layers")
            lines = drawing.lines_of(layers if isinstance(layers, dict) else drawing.layers)
            uneven = next((line for line in lines if line.unevenness > 1.0), None)
            if uneven is not None and table.get("width") == "stroke":
                stretched = f"{uneven.name} is drawn with a stroke stretched {uneven.unevenness:.2g} to 1"
                raise DesignError(f"{place}.file", f"{stretched}: remove the transform", table["file"])
            table[stored] = [stored_line(line, shift) for line in drawing.lines]
            continue
        shifted = [np.round(ring - shift, 6).tolist() for ring in rings]
        table[stored] = shifted[0] if place == "border" else shifted
        if place == "border" and isinstance(given := table.get("holes", []), list):
            both = [*given, *holes_in(shifted, table["file"])]
            table |= {"holes": both} if both else {}
    return data


def _tables(data: dict[str, Any]) -> list[tuple[str, dict[str, Any], str]]:
    """The tables that may name a drawing, as copies in place of those of a design: place, table and the stored key."""
    found = []
    for section, key, stored in (("border", "holes", "rings_mm"), ("rods", "import", "lines")):
        if not isinstance(data.get(section), dict):
            continue
        table = data[section] = dict(data[section])
        if section == "border":
            found.append((section, table, "polygon_mm"))
        if isinstance(table.get(key), list | tuple):
            table[key] = [dict(entry) if isinstance(entry, dict) else entry for entry in table[key]]
            entries = enumerate(table[key])
            found += [(f"{section}.{key}[{k}]", entry, stored) for k, entry in entries if isinstance(entry, dict)]
    return found


def _rings(place: str, table: Mapping[str, Any], drawing: Drawing) -> list[Floats]:
    """The closed curves of the layer that a table chooses, or of all layers; an outline is the largest, and the first.

    Open lines are joined within a layer.
    """
    curves = {name: closed_curves(drawing.lines_of([name])) for name in drawing.layers}
    layer = table.get("layer")
    rings = [curve for name, of_layer in curves.items() if layer in (None, name) for curve in of_layer]
    if not rings:
        known = ", ".join(sorted(name for name in curves if curves[name])) or "none"
        field = "file" if layer is None else "layer"
        raise DesignError(f"{place}.{field}", f"must have a closed line; layers with one: {known}", table[field])
    if place == "border":
        outer = max(range(len(rings)), key=lambda number: float(shapely.area(shapely.polygons(rings[number]))))
        rings = [rings[outer], *rings[:outer], *rings[outer + 1 :]]
    return rings


def holes_in(rings: list[Any], file: str) -> list[dict[str, Any]]:
    """The closed lines within an outline, the first one, as holes.

    Raises `DesignError` if a line lies beside the outline.
    """
    outline, *inner = rings
    for ring in inner:
        if not shapely.intersects(shapely.polygons(outline), shapely.polygons(ring)):
            x, y = (float(part) for part in np.mean(ring, axis=0))
            beside = f"a closed line lies beside it, about ({x:.1f}, {y:.1f}) mm"
            raise DesignError("border.file", f"must have one outline: {beside}; choose a layer", file, place_mm=(x, y))
    return [{"polygon_mm": ring} for ring in inner]


def stored_line(line: FileLine, shift: Floats, has_width: bool = True) -> dict[str, Any]:
    """Points, layer, and the width of the stroke, if there is one."""
    width = {"width_mm": round(line.width_mm, 6)} if has_width and line.width_mm is not None else {}
    return {"points_mm": np.round(line.points - shift, 6).tolist(), "layer": line.layer, **width}
