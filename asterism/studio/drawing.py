"""Drawings that a page sends: their lines, layer by layer, to be laid on the sheet as rods or as its outline."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError, NoUnitError
from asterism.pattern.design.file_lines import MM_OF_UNITS, FileLine, read_lines
from asterism.pattern.design.rods import IMPORT_CURVE_MM
from asterism.studio.uploads import UploadError

DRAWING_FORMATS = (".svg", ".dxf", ".3dm")
MAX_KEPT = 4
# ends of lines that are nearer than this are one corner of the outline
JOINED_MM = 0.01
# pictures of a drawing are simplified by this part of its size
PICTURE_TOLERANCE = 1 / 500


@dataclass(frozen=True)
class SentDrawing:
    """The visible lines of a file.

    Attributes
    ----------
    name : of the file.
    lines : in mm, y upwards.
    """

    name: str
    lines: tuple[FileLine, ...]

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of the layers, in the order of the file."""
        return tuple(dict.fromkeys(line.layer for line in self.lines))

    def lines_of(self, layers: Iterable[str]) -> list[FileLine]:
        """The lines of some layers."""
        chosen = set(layers)
        return [line for line in self.lines if line.layer in chosen]

    def data(self, number: int) -> dict[str, Any]:
        """Name, size, and layers with their widths and simplified lines, for the page."""
        size = np.ptp(np.concatenate([line.points for line in self.lines]), axis=0)
        tolerance = PICTURE_TOLERANCE * float(size.max())
        return {
            "number": number,
            "name": self.name,
            "size_mm": size.tolist(),
            "layers": [_layer_data(name, self.lines_of([name]), tolerance) for name in self.layers],
        }


class Drawings:
    """The last drawings that pages have sent, by number."""

    def __init__(self) -> None:
        self._kept: dict[int, SentDrawing] = {}
        self._count = 0

    def add(self, drawing: SentDrawing) -> int:
        """Keep a drawing; its number."""
        self._count += 1
        self._kept[self._count] = drawing
        self._kept.pop(self._count - MAX_KEPT, None)
        return self._count

    def get(self, number: int) -> SentDrawing:
        """The drawing of a number.

        Raises
        ------
        UploadError
            Later drawings have taken its place.
        """
        if (drawing := self._kept.get(number)) is None:
            raise UploadError("the drawing is not kept any more: choose its file again")
        return drawing


def read_drawing(path: Path, name: str, units: str | None = None) -> SentDrawing:
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
        return SentDrawing(name, tuple(read_lines(path, IMPORT_CURVE_MM, units)))
    except NoUnitError:
        raise
    except DesignError as error:
        raise UploadError(f"{name}: {error.allowed}") from None


def rings(lines: Iterable[FileLine]) -> list[Floats]:
    """Closed lines (n, 2) mm without their last point, the largest first; open lines that meet end to end are joined.

    Examples
    --------
    >>> corner = FileLine(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]), "cut", None)
    >>> side = FileLine(np.array([[4.0, 3.0], [0.0, 0.0]]), "cut", None)
    >>> rings([corner, side])[0].shape
    (3, 2)
    """
    closed, parts = [], []
    for line in lines:
        if len(line.points) > 3 and np.array_equal(line.points[0], line.points[-1]):
            closed.append(line.points[:-1])
        else:
            ends = np.round(line.points / JOINED_MM) * JOINED_MM
            parts.append(np.concatenate([ends[:1], line.points[1:-1], ends[-1:]]))
    if parts:
        joined = shapely.get_parts(shapely.line_merge(shapely.multilinestrings([shapely.LineString(p) for p in parts])))
        closed += [shapely.get_coordinates(line)[:-1] for line in joined if line.is_closed]
    return sorted((ring for ring in closed if len(ring) > 2), key=_area, reverse=True)


def _area(ring: Floats) -> float:
    return float(shapely.area(shapely.polygons(ring)))


def _layer_data(name: str, lines: list[FileLine], tolerance: float) -> dict[str, Any]:
    widths = [line.width_mm for line in lines if line.width_mm is not None]
    shown = shapely.get_coordinates
    pictured = [shown(shapely.LineString(line.points).simplify(tolerance)).round(3).tolist() for line in lines]
    is_closed = [len(line.points) > 3 and np.array_equal(line.points[0], line.points[-1]) for line in lines]
    return {
        "name": name,
        "count": len(lines),
        "widths_mm": [min(widths), max(widths)] if len(widths) == len(lines) else None,
        "has_rings": bool(rings(lines)),
        "is_one_ring": is_closed == [True],
        "lines": pictured,
    }
