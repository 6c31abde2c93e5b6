"""Outlines from photographs: drawings and CSV files as polygons in mm."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.measure.compare.scan import MM, ScanError, check_file
from asterism.pattern.drawing.read import MEET_MM, closed_curves, read_drawing
from asterism.pattern.drawing.records import DrawingError, NoUnitError
from asterism.pattern.geometry.planar import polygon_area
from asterism.results.csv_cells import read_rows

OUTLINE_FORMATS = (".svg", ".csv")
# largest coordinate in a CSV file, in its unit
_MAX_COORDINATE = 1e6
# mm, largest distance of a curve from its straight pieces
_CURVE_MM = 0.005
# largest gap of a closed line over the size of the drawing
_MAX_GAP = 1e-3


@dataclass(frozen=True)
class Outline:
    """The largest closed line of a file.

    Attributes
    ----------
    corners : (n, 2) mm, y upwards, not closed.
    lines : number of closed lines in the file.
    unit : unit of the numbers; None if the file gives its size.
    """

    corners: Floats
    lines: int
    unit: str | None


def read_outline(path: str | Path, unit: str | None = None) -> Outline:
    """The largest closed line in a file.

    Parameters
    ----------
    unit : unit of the numbers in a CSV file, and in a drawing without a size; mm by default.

    Raises
    ------
    ScanError, TableError
        The file is not an outline, or it gives its size and `unit` is given too.
    """
    path = Path(path)
    check_file(path)
    outline = (_from_csv if path.suffix.lower() == ".csv" else _from_drawing)(path, unit)
    corners = outline.corners
    length, width = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False) if len(corners) > 2 else (0.0, 0.0)
    if width <= 1e-12 * length:
        raise ScanError(path, "holds no outline: at least three corners, not on a line")
    if not shapely.Polygon(corners).is_valid:
        raise ScanError(path, "the outline crosses itself")
    return outline


def _from_csv(path: Path, unit: str | None) -> Outline:
    """The outline in a table with the columns x_mm and y_mm."""
    unit = unit or "mm"
    names = ("x_mm", "y_mm")
    rows = read_rows(path, names, names)
    corners = [[row.number_in(name, -_MAX_COORDINATE, _MAX_COORDINATE, needed=True) for name in names] for row in rows]
    points = np.array(corners, dtype=float).reshape(-1, 2) * MM[unit]
    closed = len(points) > 1 and np.array_equal(points[0], points[-1])
    return Outline(points[:-1] if closed else points, 1, unit)


def _from_drawing(path: Path, unit: str | None) -> Outline:
    """The largest closed line of all visible shapes of a drawing."""
    unit_mm = None if unit in (None, "mm") else MM[unit]
    try:
        drawing = read_drawing(path, _CURVE_MM, unit_mm, silent_mm=1.0, fills=True)
    except NoUnitError as error:
        raise ScanError(path, error.problem) from None
    except DrawingError as error:
        raise ScanError(path, str(error)) from None
    if drawing.has_unit and unit is not None:
        raise ScanError(path, "says its own size: --units is for files without one")
    # lines that a program has traced may miss their start by more than rounding
    rings = closed_curves(drawing.lines, max(MEET_MM, _MAX_GAP * float(drawing.size_mm.max())))
    if not rings and path.suffix.lower() == ".dxf":  # lines of CAD programs may cross at corners
        crossed = shapely.unary_union([shapely.LineString(line.points) for line in drawing.lines])
        areas = shapely.get_parts(shapely.unary_union(shapely.polygonize([crossed])))
        rings = [np.asarray(area.exterior.coords)[:-1] for area in areas if not area.is_empty]
    if not rings:
        raise ScanError(path, "holds no closed line with three corners or more")
    largest = max(rings, key=lambda ring: abs(polygon_area(ring)))
    return Outline(largest, len(rings), None if drawing.has_unit else unit or "mm")
