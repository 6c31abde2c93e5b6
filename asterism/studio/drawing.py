"""Drawings that a page sends: their lines, layer by layer, and the design with rods and outline from them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.pattern.design.border import OUTLINES
from asterism.pattern.design.drawings import IMPORT_CURVE_MM, OUTLINE_CURVE_MM, holes_in, stored_line
from asterism.pattern.drawing.read import DRAWING_FORMATS, Drawing, closed_curves
from asterism.pattern.drawing.read import read_drawing as read_lines
from asterism.pattern.drawing.records import MM_OF_UNITS, DrawingError, FileLine, NoUnitError
from asterism.pattern.layout.pin_placement import PIN_TOLERANCE_MM
from asterism.studio.requests import LayerUse, PlaceDrawing


class UploadError(Error, ValueError):
    """A file that cannot be used; the message is one line."""


def check_corners(count: int) -> None:
    """Raise UploadError if an outline has too many corners."""
    if count > 1000:
        raise UploadError(f"the outline has {count} corners; at most 1000 are allowed")


def drawing_data(drawing: Drawing, number: int) -> dict[str, Any]:
    """Name, size, and layers with their widths and simplified lines, for the page."""
    # pictures of a drawing are simplified by this part of its size
    tolerance = float(drawing.size_mm.max()) / 500
    return {
        "number": number,
        "name": drawing.name,
        "size_mm": drawing.size_mm.tolist(),
        "left_out": drawing.left_out,
        "layers": [_layer_data(name, drawing.lines_of([name]), tolerance) for name in drawing.layers],
    }


class Drawings:
    """The last drawings that pages have sent, by number."""

    def __init__(self) -> None:
        self._kept: dict[int, Drawing] = {}
        self._count = 0

    def add(self, drawing: Drawing) -> int:
        """Keep a drawing; its number."""
        self._count += 1
        self._kept[self._count] = drawing
        self._kept.pop(self._count - 4, None)
        return self._count

    def get(self, number: int) -> Drawing:
        """The drawing of a number.

        Raises
        ------
        UploadError
            Later drawings have taken its place.
        """
        if (drawing := self._kept.get(number)) is None:
            raise UploadError("the drawing is not kept any more: choose its file again")
        return drawing


def read_drawing(path: Path, name: str, units: str | None = None) -> Drawing:
    """The drawing in a file.

    Parameters
    ----------
    name : of the file as the page gives it.
    units : unit of a file that gives none; a key of `MM_OF_UNITS`.

    Raises
    ------
    NoUnitError
        The file has no unit, and none is given.
    UploadError
        The file cannot be read, or holds no line.
    """
    if path.suffix.lower() not in DRAWING_FORMATS:
        raise UploadError(f"{name}: a drawing must be a file of {', '.join(DRAWING_FORMATS)}")
    if units is not None and units not in MM_OF_UNITS:
        raise UploadError(f"the unit must be one of {', '.join(MM_OF_UNITS)}")
    try:
        return replace(read_lines(path, IMPORT_CURVE_MM, MM_OF_UNITS.get(units or "")), name=name)
    except NoUnitError:
        raise
    except DrawingError as error:
        raise UploadError(f"{name}: {error}") from None


def _rings(lines: Iterable[FileLine]) -> list[Floats]:
    """Closed curves (n, 2) mm without their last point, the largest first."""
    return sorted(closed_curves(lines), key=lambda ring: -float(shapely.area(shapely.polygons(ring))))


def _layer_data(name: str, lines: list[FileLine], tolerance: float) -> dict[str, Any]:
    widths = [line.width_mm for line in lines if line.width_mm is not None]
    simple = shapely.simplify([shapely.LineString(line.points) for line in lines], tolerance)
    return {
        "name": name,
        "count": len(lines),
        "widths_mm": [min(widths), max(widths)] if len(widths) == len(lines) else None,
        "has_rings": bool(_rings(lines)),
        "is_one_ring": [line.is_closed for line in lines] == [True],
        "lines": [shapely.get_coordinates(line).round(3).tolist() for line in simple],
    }


# keys of the border that give an outline
OUTLINE_KEYS = (*OUTLINES, "bulge_mm", "file", "layer", "origin", "units")


def with_drawing(
    table: Mapping[str, Any], drawing: Drawing, choice: PlaceDrawing, outline: Floats
) -> tuple[dict[str, Any], str]:
    """The table of a design with a drawing, and a line on what another outline has left out.

    Lines are stored in the design, so that no file is needed. A section that all layers share becomes that of `[rods]`,
    where the pattern is new: a profile over the sheet can take its place.

    Parameters
    ----------
    outline : (B, 2) mm of the sheet, for borders whose outline depends on the stars that are replaced.

    Raises
    ------
    UploadError, DesignError
        The choice names no layer of the drawing, or the layers of the outline hold no closed line, or one beside it.
    """
    chosen = {name: layer for name, layer in choice.layers.items() if name in drawing.layers}
    if not chosen:
        raise UploadError("choose a layer for the rods or for the outline")
    rods = [name for name, layer in chosen.items() if layer.use in ("rods", "both")]
    edges = [name for name, layer in chosen.items() if layer.use == "outline"]
    rim = next((name for name, layer in chosen.items() if layer.use == "both"), None)
    outer = _rings(drawing.lines_of(edges or [rim] if rim else edges))
    if (edges or rim) and not outer:
        raise UploadError(f"{drawing.name}: {', '.join(edges) or rim}: an outline must have a closed line")
    box = outer[0] if outer else np.concatenate([line.points for line in drawing.lines_of(rods)])
    shift = 0.5 * (box.min(axis=0) + box.max(axis=0)) if choice.origin == "middle" else np.zeros(2)
    changed = dict(table)
    if rods:
        changed = _with_rods(changed, drawing, {name: chosen[name] for name in rods}, shift, choice)
    if edges or rim:
        rims = [ring - shift for ring in (outer if edges else outer[:1])]
        changed["border"] = _border(changed, rim, rims if edges else [], drawing.name)
        return _with_pins_on(changed, rims)
    if choice.sheet == "around":
        margin_mm = 10.0  # of fabric around the drawing
        low, high = box.min(axis=0) - shift - margin_mm, box.max(axis=0) - shift + margin_mm
        corners = np.round([low, [high[0], low[1]], high, [low[0], high[1]]], 3)
        changed["border"] = {**_without_outline(changed), "polygon_mm": corners.tolist()}
        return _with_pins_on(changed, [corners])
    changed["border"] = _kept_border(changed, outline)
    return changed, ""


def _with_rods(
    table: dict[str, Any], drawing: Drawing, layers: dict[str, LayerUse], shift: Floats, choice: PlaceDrawing
) -> dict[str, Any]:
    sizes: dict[str, dict[str, Any]] = {name: {"thickness_mm": layer.thickness} for name, layer in layers.items()}
    entry: dict[str, Any] = {"file": drawing.name, "layers": sizes}
    if choice.strokes:
        entry["width"] = "stroke"
    else:
        for name, layer in layers.items():
            sizes[name]["width_mm"] = layer.width
    shown = dict(table)
    if choice.keep:
        rods = dict(table.get("rods", {}))
    else:
        kept = ("rounding", "curve_mm", "join_mm")  # by a new pattern
        rods = {key: value for key, value in table.get("rods", {}).items() if key in kept}
        for key in ("stars", "fit"):
            shown.pop(key, None)
        for key in ("thickness_mm", "width_mm"):
            values = {size.get(key) for size in sizes.values()}
            if len(values) == 1 and (value := values.pop()) is not None:
                rods[key] = value
                for size in sizes.values():
                    del size[key]
    entry["lines"] = [stored_line(line, shift, choice.strokes) for line in drawing.lines_of(layers)]
    shown["rods"] = {**rods, "import": [*rods.get("import", ()), entry]}
    return shown


def _border(table: Mapping[str, Any], rim: str | None, outer: list[Floats], file: str) -> dict[str, Any]:
    """The border whose outline is the largest ring, with the others as holes, or a closed rod of this name."""
    kept = _without_outline(table)
    if not outer:
        return {**kept, "rods": rim}
    rings = [_corners(ring) for ring in outer]
    holes = holes_in(rings, file)
    return {**kept, "polygon_mm": rings[0], **({"holes": holes} if holes else {})}


def _corners(ring: Floats) -> list[list[float]]:
    """The corners of a ring, with as few as a print can show."""
    closed = shapely.LineString(np.concatenate([ring, ring[:1]])).simplify(OUTLINE_CURVE_MM)
    corners = shapely.get_coordinates(closed)[:-1]
    check_corners(len(corners))
    listed: list[list[float]] = corners.round(6).tolist()
    return listed


def _kept_border(table: Mapping[str, Any], outline: Floats) -> dict[str, Any]:
    """The border as it is; an outline that stars or rods give becomes a polygon where these may have gone."""
    border = dict(table["border"])
    if ("rings" in border and "stars" not in table) or "rods" in border:
        border = {key: value for key, value in border.items() if key not in OUTLINE_KEYS}
        border["polygon_mm"] = outline.round(6).tolist()
    return border


def _with_pins_on(table: dict[str, Any], rims: list[Floats]) -> tuple[dict[str, Any], str]:
    """The table with the supports that another outline leaves, and a line on the others.

    Numbers of edges, corners and holes are those of the former outline.

    Parameters
    ----------
    rims : (n, 2) mm, of the outline and of its holes.
    """
    kept, lost = [], 0
    sheet = shapely.Polygon(rims[0], rims[1:]).buffer(PIN_TOLERANCE_MM)
    for pins in table.get("pins", ()):
        if "points_mm" not in pins:
            kept += [pins] if "where" in pins else []
            lost += "where" not in pins
            continue
        is_on = shapely.covers(sheet, shapely.points(np.asarray(pins["points_mm"], dtype=float)))
        lost += int((~is_on).sum())
        if not is_on.any():
            continue
        of_points = {"points_mm", *(["target_mm"] if np.ndim(pins.get("target_mm", 0)) == 2 else [])}
        kept.append(pins | {key: [each for each, on in zip(pins[key], is_on, strict=True) if on] for key in of_points})
    if not lost:
        return table, ""
    rest = {key: value for key, value in table.items() if key != "pins"}
    supports = "1 support of the former outline is" if lost == 1 else f"{lost} supports of the former outline are"
    note = f"{supports} left out; Undo brings the former sheet back."
    return rest | ({"pins": kept} if kept else {}), note


def _without_outline(table: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table["border"].items() if key not in (*OUTLINE_KEYS, "holes")}
