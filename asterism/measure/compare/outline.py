"""Outlines from photographs: SVG and CSV files as polygons in mm."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO
from xml.etree import ElementTree

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.measure.compare.errors import ScanError, check_file
from asterism.measure.compare.units import MM
from asterism.pattern.geometry.planar import polygon_area
from asterism.results.csv_cells import read_rows

OUTLINE_FORMATS = (".svg", ".csv")
# largest coordinate, in the unit of the file
_MAX_COORDINATE = 1e6
# units of width and height that determine the size of the drawing
_LENGTH_UNITS = ("mm", "cm", "in", "pt", "pc")
# all widths and heights that SVG allows
_SVG_SIZE = re.compile(rf"([+]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?\s*({'|'.join(_LENGTH_UNITS)}|px|%|em|ex)?|auto)?")


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
    unit : unit of the numbers in a CSV file, and in an SVG file without a size; mm by default.

    Raises
    ------
    ScanError, TableError
        The file is not an outline, or it gives its size and `unit` is given too.
    """
    path = Path(path)
    check_file(path)
    outline = (_from_csv if path.suffix.lower() == ".csv" else _from_svg)(path, unit)
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
    rows = read_rows(path, ("x_mm", "y_mm"), ("x_mm", "y_mm"))
    names = ("x_mm", "y_mm")
    corners = [[row.number_in(name, -_MAX_COORDINATE, _MAX_COORDINATE, needed=True) for name in names] for row in rows]
    points = np.array(corners, dtype=float).reshape(-1, 2) * MM[unit]
    closed = len(points) > 1 and np.array_equal(points[0], points[-1])
    return Outline(points[:-1] if closed else points, 1, unit)


def _from_svg(path: Path, unit: str | None) -> Outline:
    """The largest closed line of all visible shapes of a drawing."""
    import svgelements as svg  # slow to import

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            drawing = svg.SVG.parse(_drawn(path), reify=True, ppi=96)
    except Exception as error:
        reason = str(error).strip().split("\n")[0] or type(error).__name__
        raise ScanError(path, f"cannot be read as SVG: {reason}") from None
    if not isinstance(drawing, svg.SVG):
        raise ScanError(path, "is not a drawing in SVG")
    said = [str(drawing.values.get(side, "")).strip().lower() for side in ("width", "height")]
    if odd := next((text for text in said if not _SVG_SIZE.fullmatch(text)), None):
        hint = "; decimals have a point" if "," in odd else ""
        raise ScanError(path, f"has the size {odd!r}: must be a number and a unit, 120mm{hint}")
    measured = all(text.endswith(_LENGTH_UNITS) for text in said)
    lines: list[Floats] = []
    opened: list[Floats] = []
    for shape in drawing.elements(lambda element: isinstance(element, svg.Shape)):
        if shape.values.get("visibility") in ("hidden", "collapse"):
            continue
        for part in svg.Path(shape).as_subpaths():
            places = [(p.x, p.y) for piece in svg.Path(part) for p in _points(piece)]
            if len(places) >= 3:
                line = np.array(places, dtype=float)
                # programs round coordinates
                closed = np.linalg.norm(line[0] - line[-1]) <= 1e-3 * np.linalg.norm(np.ptp(line, axis=0))
                (lines if closed else opened).append(line)
    if not lines:
        raise ScanError(path, f"holds no {'closed ' if opened else ''}line with three corners or more")
    largest = max(lines, key=lambda line: abs(polygon_area(line)))
    if not np.isfinite(largest).all() or np.abs(largest).max() > _MAX_COORDINATE:
        raise ScanError(path, "holds places that are not finite numbers, or too large")
    if measured and unit is not None:
        raise ScanError(path, f"says its own size, {' x '.join(said)}: --units is for files without one")
    unit = None if measured else unit or "mm"
    if unit == "mm" and any(said):  # numbers without a unit are px, and percentages refer to a page
        how = "%" if "%" in "".join(said) else "px"
        raise ScanError(path, f"has its size in {how}: give width and height in mm")
    steps = np.linalg.norm(np.diff(largest, axis=0, append=largest[:1]), axis=1)
    # svgelements gives pixels, of which the SVG standard has 96 an inch
    corners = largest[steps > 1e-9] * [1.0, -1.0] * (MM[unit] if unit else MM["in"] / 96.0)
    return Outline(corners, len(lines), unit)


def _drawn(path: Path) -> BinaryIO:
    """A drawing without invisible elements, which svgelements would read as lines of the drawing."""
    tree = ElementTree.parse(path).getroot()
    for parent in list(tree.iter()):
        for child in list(parent):
            space, _, name = str(child.tag).rpartition("}")
            if name in ("marker", "mask"):
                parent.remove(child)
            elif name == "symbol":
                place = f"{space}}}" if space else ""
                child.tag = f"{place}g"
                kept = ElementTree.Element(f"{place}defs")
                parent[list(parent).index(child)] = kept
                kept.append(child)
    return BytesIO(ElementTree.tostring(tree))


def _points(piece: Any) -> list[Any]:
    """Points along one piece of a path, with its end."""
    import svgelements as svg

    if isinstance(piece, svg.Line | svg.Close | svg.Move):
        return [piece.end] if piece.end is not None else []
    return [piece.point(k / 100) for k in range(1, 101)]
