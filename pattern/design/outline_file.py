"""The outline of the sheet and its holes, from the closed lines of a drawing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.file_lines import MM_OF_UNITS, closed_lines, read_lines

# mm, largest distance of a curve from the straight edges of the sheet
OUTLINE_CURVE_MM = 0.02


def with_outline(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The table `[border]` with the outline and the holes of its `file`, if they were not read before.

    Raises
    ------
    DesignError
        The file cannot be read, or its closed lines are not one outline with holes.
    """
    file, layer, units = (data.get(key) for key in ("file", "layer", "units"))
    if not isinstance(file, str) or data.get("polygon_mm") is not None:
        return data
    known_unit = units if isinstance(units, str) and units in MM_OF_UNITS else None
    lines = read_lines(folder / file, OUTLINE_CURVE_MM, known_unit)
    rings = [line.points[:-1] for line in closed_lines(lines, layer, file)]
    outer = max(range(len(rings)), key=lambda number: shapely.area(shapely.polygons(rings[number])))
    shift = np.zeros(2)
    if data.get("origin", "middle") == "middle":
        shift = 0.5 * (rings[outer].min(axis=0) + rings[outer].max(axis=0))
    outline, *inner = (
        np.round(ring - shift, 6).tolist() for ring in (rings[outer], *rings[:outer], *rings[outer + 1 :])
    )
    beside = [ring for ring in inner if not shapely.intersects(shapely.polygons(outline), shapely.polygons(ring))]
    if beside:
        x, y = (float(part) for part in np.mean(beside[0], axis=0))
        problem = f"must have one outline: a closed line lies beside it, about ({x:.1f}, {y:.1f}) mm; choose a layer"
        raise DesignError("file", problem, file, place_mm=(x, y))
    holes = [{"polygon_mm": ring} for ring in inner]
    given = data.get("holes", ())
    if isinstance(given, list | tuple) and holes:
        data = {**data, "holes": [*given, *holes]}
    return {**data, "polygon_mm": outline}
