"""Holes in the sheet, in the section `[border]`."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationInfo, model_validator

from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.file_lines import MM_OF_UNITS, closed_lines, read_lines
from asterism.pattern.design.rods import IMPORT_CURVE_MM, DrawnCircle
from asterism.pattern.design.section import Line, Point, Section, Text

MAX_HOLES = 1000


class Hole(Section):
    """A hole, or several of a drawing: one of `circle_mm`, `polygon_mm`, `spline_mm`, `rods` and `file`.

    Attributes
    ----------
    circle_mm, polygon_mm, spline_mm : the edge of the hole; the polygon and the spline return to their first point.
    rods : name of a closed line of `[rods]` that is the edge: the fabric within it is cut out along its inner edge.
    file : SVG, DXF or 3DM file. Its closed lines are edges of holes.
    layer : of the file; by default all closed lines.
    origin, units : as of `[[rods.import]]`.
    rings_mm : the edges that were read from the file.

    Examples
    --------
    >>> Hole(polygon_mm=[(0.0, 0.0), (5.0, 0.0), (0.0, 5.0)]).kind
    'polygon_mm'
    """

    circle_mm: DrawnCircle | None = None
    polygon_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=10_000)
    spline_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=10_000)
    rods: Line | None = None
    file: Text | None = None
    layer: Text | None = None
    origin: Literal["middle", "drawing"] = "middle"
    units: Literal["mm", "cm", "in", "px"] | None = None
    rings_mm: tuple[tuple[Point, ...], ...] = Field((), max_length=MAX_HOLES, repr=False)

    @property
    def kind(self) -> str:
        """Which of the keys has the edge."""
        return next(key for key in _KINDS if getattr(self, key) is not None)

    @model_validator(mode="before")
    @classmethod
    def _read(cls, data: Any, info: ValidationInfo) -> Any:
        if not isinstance(data, dict) or data.get("rings_mm") or not isinstance(data.get("file"), str):
            return data
        units, path = data.get("units"), (info.context or {}).get("folder", Path()) / data["file"]
        lines = read_lines(path, IMPORT_CURVE_MM, units if isinstance(units, str) and units in MM_OF_UNITS else None)
        everything = np.concatenate([line.points for line in lines])
        middle = 0.5 * (everything.min(axis=0) + everything.max(axis=0))
        shift = middle if data.get("origin", "middle") == "middle" else np.zeros(2)
        chosen = closed_lines(lines, data.get("layer"), data["file"])
        return {**data, "rings_mm": [np.round(line.points[:-1] - shift, 6).tolist() for line in chosen]}

    @model_validator(mode="after")
    def _one_edge(self) -> Self:
        self._check_one_of(*_KINDS)
        if self.layer is not None and self.file is None:
            raise DesignError("layer", "goes with file", self.layer)
        return self


_KINDS = ("circle_mm", "polygon_mm", "spline_mm", "rods", "file")
