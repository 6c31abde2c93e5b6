"""Drawings of other programs: their lines in mm, and the closed curves that these form."""

from __future__ import annotations

import os
import re
import warnings
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.errors import one_line
from asterism.pattern.drawing.dxf import open_dxf
from asterism.pattern.drawing.records import MM_OF_UNITS, DrawingError, DrawingWarning, FileLine, NoUnitError
from asterism.pattern.drawing.rhino import RHINO_FORMAT, open_rhino_drawing
from asterism.pattern.drawing.svg import open_svg
from asterism.pattern.geometry.planar import clusters

DRAWING_FORMATS = (".svg", ".dxf", RHINO_FORMAT)
# ends of lines that are nearer than this meet: programs round coordinates
MEET_MM = 0.01
_MAX_BYTES = 20_000_000
_MAX_LINES = 20_000
_MAX_SIZE_MM = 2e5
_SAME_PLACE_MM = 1e-4


@dataclass(frozen=True)
class Drawing:
    """The visible lines of a file."""

    name: str  # of the file
    lines: tuple[FileLine, ...]  # in mm, y upwards, in the order of the file
    has_unit: bool  # the file says the unit of its numbers
    left_out: str = ""  # what is not read, in words: `2 texts, 1 picture`

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of the layers, in the order of the file."""
        return tuple(dict.fromkeys(line.layer for line in self.lines))

    def lines_of(self, layers: Iterable[str]) -> list[FileLine]:
        """The lines of some layers."""
        chosen = set(layers)
        return [line for line in self.lines if line.layer in chosen]

    @property
    def size_mm(self) -> Floats:
        """(2,) of the box around all lines."""
        return _size(self.lines)


def read_drawing(
    path: Path, curve_mm: float, unit_mm: float | None = None, silent_mm: float | None = None, fills: bool = False
) -> Drawing:
    """All visible lines of a drawing; a `DrawingWarning` counts what is left out.

    Raises `DrawingError` if the file cannot be read, or holds no line. Raises `NoUnitError` if the file has no unit,
    and none is given.

    Parameters
    ----------
    path : file that ends in .svg, .dxf or .3dm.
    curve_mm : largest distance of a curve from the polyline that stands for it.
    unit_mm : unit of a file that gives none, and in place of that of a 3DM file.
    silent_mm : unit of a file that says nothing of its size.
    fills : read the edges of shapes in SVG that have a fill only.
    """
    if not os.path.isfile(path):  # names may be too long
        raise DrawingError(f"there is no such file in {path.parent.absolute()}")
    if path.stat().st_size > _MAX_BYTES:
        raise DrawingError(f"must be at most {_MAX_BYTES // 1_000_000} MB")
    if (ending := path.suffix.lower()) not in DRAWING_FORMATS:
        raise DrawingError("must end in .svg, .dxf or .3dm")
    if ending == RHINO_FORMAT:
        source = open_rhino_drawing(path, unit_mm)
    else:
        source = open_svg(path, fills) if ending == ".svg" else open_dxf(path)
    mm = source.mm or unit_mm or (silent_mm if source.is_silent else None)
    scale, left_out = mm or 1.0, Counter[str]()
    lines = []
    for line in source.lines(curve_mm / scale, left_out):
        points = _cleaned(scale * line.points)
        if len(points) > 1:
            layer = line.layer.encode(errors="replace").decode()  # DXF may hold bytes that are no text
            width = line.width_mm and scale * line.width_mm
            lines.append(replace(line, points=points, layer=layer, width_mm=width))
            if len(lines) > _MAX_LINES:
                raise DrawingError(f"holds more than {_MAX_LINES} lines")
    # `text|s` is a text, or several texts
    counted = ((n, re.sub("[|]([a-z]*)", r"\1" if n > 1 else "", what)) for what, n in left_out.items() if n)
    parts = (f"{n} {what}" for n, what in counted)
    rest = one_line(", ".join(parts))
    if not lines:
        raise DrawingError("holds no line with a stroke" + (f"; left out: {rest}" if rest else ""))
    size = _size(lines)
    if mm is None:
        units = ("mm", "px", "pt") if ending == ".svg" else ("mm", "cm", "in")
        sizes = ", ".join(f'"{unit}" makes it {_in_words(MM_OF_UNITS[unit] * size)}' for unit in units)
        raise NoUnitError(source.problem, sizes)
    # lines may be far apart: another layer is often beside the place of the first
    if large := next((line for line in lines if _size([line]).max() > _MAX_SIZE_MM), None):
        place = f"{large.name} in layer {large.layer!r} is {_in_words(_size([large]))} large"
        raise DrawingError(f"{place}: at most {_MAX_SIZE_MM / 1000:g} m are allowed")
    if rest:
        layers = len({line.layer for line in lines})
        read = f"read {len(lines)} line{'s'[: len(lines) > 1]} in {layers} layer{'s'[: layers > 1]}, {_in_words(size)}"
        warnings.warn(one_line(f"{path.name}: {read}; left out: {rest}"), DrawingWarning, stacklevel=2)
    return Drawing(path.name, tuple(lines), source.mm is not None, rest)


def closed_curves(lines: Iterable[FileLine], meet_mm: float = MEET_MM) -> list[Floats]:
    """Closed lines (n, 2) mm without their last point, then those that open lines form which meet end to end.

    >>> corner = FileLine(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]), "cut", None)
    >>> side = FileLine(np.array([[4.0, 3.004], [0.0, 0.0]]), "cut", None)
    >>> closed_curves([corner, side])[0].shape
    (3, 2)
    """
    lines = list(lines)
    closed = [line.points[:-1] for line in lines if line.is_closed]
    parts = [line.points for line in lines if not line.is_closed]
    if parts:
        node, places = clusters(np.concatenate([points[[0, -1]] for points in parts]), _SAME_PLACE_MM)
        ends = places[node]
        # only ends that meet nothing are moved: lines may be shorter than the gap
        loose = np.bincount(node)[node] == 1
        near, places = clusters(ends[loose], meet_mm)
        ends[loose] = places[near]
        pairs = zip(parts, ends.reshape(-1, 2, 2), strict=True)
        met = [np.concatenate([end[:1], points[1:-1], end[1:]]) for points, end in pairs]
        chains = shapely.line_merge(shapely.multilinestrings([shapely.LineString(points) for points in met]))
        closed += [shapely.get_coordinates(line)[:-1] for line in shapely.get_parts(chains) if line.is_closed]
    return [curve for curve in closed if len(curve) > 2]


def box_middle(lines: Iterable[FileLine]) -> Floats:
    """(2,) mm, the middle of the box around lines."""
    points = np.concatenate([line.points for line in lines])
    return np.asarray(0.5 * (points.min(axis=0) + points.max(axis=0)))


def _size(lines: Iterable[FileLine]) -> Floats:
    return np.asarray(np.ptp(np.concatenate([line.points for line in lines]), axis=0))


def _in_words(size: Floats) -> str:
    return f"{size[0]:.4g} x {size[1]:.4g} mm"


def _cleaned(points: Floats) -> Floats:
    """The points without those that repeat the one before; a line that returns to its start ends with it exactly."""
    step = np.linalg.norm(np.diff(points, axis=0), axis=1)
    kept = points[np.concatenate([[True], step > _SAME_PLACE_MM])[: len(points)]]
    if len(kept) > 3 and np.linalg.norm(kept[0] - kept[-1]) <= MEET_MM:
        kept[-1] = kept[0]
    return kept
