"""Files that a page sends: grey pictures for star sizes, and outlines, also from drawings in DXF."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import Error
from asterism.measure.compare.errors import ScanError, check_file
from asterism.measure.compare.outline import OUTLINE_FORMATS, read_outline
from asterism.pattern.design.file_lines import DXF_NEEDED
from asterism.pattern.design.sizing.grey_image import ImageError, pack_image, read_grey

LINES = "LINE LWPOLYLINE POLYLINE ARC CIRCLE ELLIPSE SPLINE"
# ends of lines that are nearer than this meet
MAX_GAP_MM = 0.01
MAX_ENTITIES = 20_000
MAX_UPLOAD_BYTES = 8_000_000
MAX_CORNERS = 1000


class UploadKind(StrEnum):
    """What a file is for."""

    IMAGE = "image"
    OUTLINE = "outline"
    TARGET = "target"
    DRAWING = "drawing"


class UploadError(Error, ValueError):
    """A file that cannot be used; the message is one line."""


def read_upload(kind: UploadKind, path: Path, name: str = "") -> dict[str, Any]:
    """The part of a design file that a file stands for.

    Parameters
    ----------
    name : of the file as the page gives it; it goes into the design as a note.

    Returns
    -------
    `{"value": {...}}` for a picture: a sizing profile without `low`, `high` and `extent_mm`; `{"border": {...}}` for an
    outline.

    Raises
    ------
    UploadError, ScanError
        The file cannot be read as such.
    """
    if kind is UploadKind.IMAGE:
        try:
            grey = read_grey(path)
        except ImageError as error:
            raise UploadError(f"the picture {error}") from None
        rows, columns = grey.shape
        return {"value": {"image": name or path.name, "pixels": [columns, rows], "grey": pack_image(grey)}}
    if path.suffix not in (*OUTLINE_FORMATS, ".dxf"):
        raise UploadError(f"an outline must be a file of {', '.join((*OUTLINE_FORMATS, '.dxf'))}")
    return {"border": {"polygon_mm": border_corners(read_outline(path).corners).round(4).tolist()}}


def border_corners(corners: Floats) -> Floats:
    """An outline for a design: around the origin, counterclockwise, and with as few corners as a print can show.

    Raises
    ------
    UploadError
        The outline still has too many corners.
    """
    # Corners that are nearer to the line between their neighbours are left out.
    polygon = shapely.Polygon(corners).simplify(0.05)
    simple: Floats = np.asarray(shapely.geometry.polygon.orient(polygon).exterior.coords)[:-1, :2]
    if len(simple) > MAX_CORNERS:
        raise UploadError(f"the outline has {len(simple)} corners; at most {MAX_CORNERS} are allowed")
    centred: Floats = simple - (simple.min(axis=0) + simple.max(axis=0)) / 2
    return centred


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
    # mm of the drawing's unit by its number in the header, $INSUNITS; drawings without a unit are in mm
    units_mm = {0: 1.0, 1: 25.4, 2: 304.8, 4: 1.0, 5: 10.0, 6: 1000.0, 14: 100.0}
    unit = units_mm.get(int(drawing.header.get("$INSUNITS", 0)))
    if unit is None:
        raise ScanError(path, "has another unit than mm, cm, dm, m, inch or foot")
    entities = drawing.modelspace().query(LINES)
    if len(entities) > MAX_ENTITIES:
        raise ScanError(path, f"has {len(entities)} lines; at most {MAX_ENTITIES} are allowed")
    lines = []
    for entity in entities:
        # distance of a curve from its pieces
        points = np.array([(p.x, p.y) for p in make_path(entity).flattening(0.01 / unit)]) * unit
        if len(points) > 1 and np.isfinite(points).all() and np.abs(points).max() <= 1e6:
            lines.append(shapely.LineString(np.round(points / MAX_GAP_MM) * MAX_GAP_MM))
    areas = shapely.get_parts(shapely.polygonize([shapely.unary_union(lines)])) if lines else []
    whole = shapely.get_parts(shapely.unary_union(areas)) if len(areas) else []
    if not len(whole):
        raise ScanError(path, "holds no closed line")
    largest = max(whole, key=lambda area: float(area.area))
    corners: Floats = np.asarray(largest.exterior.coords)[:-1, :2]
    return corners
