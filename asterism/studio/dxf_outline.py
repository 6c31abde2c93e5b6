"""The outline of a sheet from a drawing in DXF."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.measure.compare.errors import ScanError, check_file
from asterism.pattern.design.file_lines import DXF_NEEDED

# mm of the drawing's unit by its number in the header, $INSUNITS; drawings without a unit are in mm
UNIT_MM = {0: 1.0, 1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0, 14: 100.0}
LINES = "LINE LWPOLYLINE POLYLINE ARC CIRCLE ELLIPSE SPLINE"
# distance of a curve from its pieces
MAX_SAGITTA_MM = 0.01
# ends of lines that are nearer than this meet
MAX_GAP_MM = 0.01
MAX_ENTITIES = 20_000
MAX_OUTLINE_MM = 1e6


def read_dxf_outline(path: Path) -> Floats:
    """The largest area that the lines of a drawing enclose.

    Returns
    -------
    Corners (n, 2) in mm, not closed. Holes are left out.

    Raises
    ------
    ScanError
        The file is not a drawing, or its lines enclose no area.
    """
    try:
        from ezdxf import recover
        from ezdxf.lldxf.const import DXFError
        from ezdxf.path import make_path
    except ImportError:
        raise ScanError(path, DXF_NEEDED) from None
    check_file(path)
    try:
        drawing, _ = recover.readfile(path)
    except (DXFError, OSError, ValueError, IndexError, KeyError) as error:
        raise ScanError(path, f"cannot be read as DXF: {type(error).__name__}") from None
    unit = UNIT_MM.get(int(drawing.header.get("$INSUNITS", 0)))
    if unit is None:
        raise ScanError(path, "has another unit than mm, cm, dm, m, inch or foot")
    entities = drawing.modelspace().query(LINES)
    if len(entities) > MAX_ENTITIES:
        raise ScanError(path, f"has {len(entities)} lines; at most {MAX_ENTITIES} are allowed")
    lines = []
    for entity in entities:
        points = np.array([(p.x, p.y) for p in make_path(entity).flattening(MAX_SAGITTA_MM / unit)]) * unit
        if len(points) > 1 and np.isfinite(points).all() and np.abs(points).max() <= MAX_OUTLINE_MM:
            lines.append(shapely.LineString(np.round(points / MAX_GAP_MM) * MAX_GAP_MM))
    areas = shapely.get_parts(shapely.polygonize([shapely.unary_union(lines)])) if lines else []
    whole = shapely.get_parts(shapely.unary_union(areas)) if len(areas) else []
    if not len(whole):
        raise ScanError(path, "holds no closed line")
    largest = max(whole, key=lambda area: float(area.area))
    corners: Floats = np.asarray(largest.exterior.coords)[:-1, :2]
    return corners
