"""The outline of the sheet, and which stars of the lattice stand on it."""

from __future__ import annotations

from typing import Literal

import numpy as np
import shapely
from pydantic import Field, model_validator

from pattern.design.errors import DesignError
from pattern.design.lattice import Lattice
from pattern.design.section import Number, Point, Section, Whole
from pattern.geometry.arrays import Floats, Ints

MOST_STARS, MOST_LISTED = 5000, 5_000_000
LARGEST_MM = 5000.0


class Border(Section):
    """The outline: one of `rings`, `rectangle_mm` and `polygon_mm`.

    Attributes
    ----------
    rings : hexagon around this many rings of stars about the central one (triangular lattice only).
    rectangle_mm : width and height, centred on the origin.
    polygon_mm : corners in order, either way round.
    star_margin_mm : stars stand at least this far inside a rectangle or polygon; half the spacing by default,
        which leaves the outer stars a full cell of fabric.
    overhang : arms that would leave the sheet are `cut` short of the outline, or the design is `refuse`d.
    tip_margin_mm : fabric left between an arm's tip and the outline.
    """

    rings: Whole | None = Field(None, ge=0, le=40)
    rectangle_mm: Point | None = None
    polygon_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=1000)
    star_margin_mm: Number | None = Field(None, ge=1, le=1000)
    overhang: Literal["cut", "refuse"] = "cut"
    tip_margin_mm: Number = Field(0.5, ge=0.1, le=100)

    @model_validator(mode="after")
    def _one_outline(self) -> Border:
        self._check_one_of("rings", "rectangle_mm", "polygon_mm")
        if self.rectangle_mm is not None and not all(1 <= side <= LARGEST_MM for side in self.rectangle_mm):
            raise DesignError("rectangle_mm", f"must be two sides from 1 to {LARGEST_MM:g} mm", self.rectangle_mm)
        if self.polygon_mm is not None:
            _check_polygon(self.polygon_mm)
        if self.rings is not None and self.star_margin_mm is not None:
            raise DesignError(
                "star_margin_mm", "goes with rectangle_mm or polygon_mm, not with rings", self.star_margin_mm
            )
        if self.star_margin_mm is not None and self.star_margin_mm <= self.tip_margin_mm:
            raise DesignError(
                "star_margin_mm", f"must exceed tip_margin_mm ({self.tip_margin_mm:g})", self.star_margin_mm
            )
        return self


def outline(border: Border, lattice: Lattice) -> Floats:
    """(B, 2) mm, corners of the sheet, counterclockwise."""
    if border.rings is not None:
        if lattice.kind != "triangular":
            raise DesignError("border.rings", 'needs lattice.kind = "triangular"', border.rings)
        if lattice.origin_mm != (0.0, 0.0):
            raise DesignError("lattice.origin_mm", "must be [0, 0] with border.rings", lattice.origin_mm)
        # 15 mm beyond the outermost star's centre for the paper's spacing of 10 sqrt(3) mm
        radius = lattice.spacing_mm * (border.rings + 1.5 / np.sqrt(3.0))
        if radius > LARGEST_MM:
            raise DesignError("border.rings", f"must make a sheet of at most {LARGEST_MM:g} mm", border.rings)
        angle = np.radians(30 + 60 * np.arange(6))
        return radius * np.column_stack([np.cos(angle), np.sin(angle)])
    if border.rectangle_mm is not None:
        return np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.asarray(border.rectangle_mm) / 2
    corners = np.asarray(border.polygon_mm)
    return corners if shapely.is_ccw(shapely.linearrings(corners)) else corners[::-1].copy()


def star_margin_mm(border: Border, lattice: Lattice) -> float:
    """How far stars stand inside a rectangle or polygon at least."""
    return lattice.spacing_mm / 2 if border.star_margin_mm is None else border.star_margin_mm


def star_cells(border: Border, lattice: Lattice, corners: Floats) -> Ints:
    """(n, 2) lattice cells with a star, from the origin outwards, counterclockwise at equal distance."""
    if border.rings is not None:
        i, j = lattice.cells_within(*_box(corners)).T
        # i + j is the third of the hexagonal coordinates
        ring = np.max(np.abs([i, j, i + j]), axis=0)
        cells = np.column_stack([i, j])[ring <= border.rings]
    else:
        _check_count(lattice, corners)
        cells = lattice.cells_within(*_box(corners))
        margin = star_margin_mm(border, lattice)
        centres = shapely.points(lattice.place(cells))
        sheet = shapely.polygons(corners)
        shapely.prepare(sheet)
        inside = shapely.covers(sheet, centres)
        # a rounding error does not take away a star that is exactly at the margin
        inside[inside] = shapely.distance(sheet.exterior, centres[inside]) >= margin * (1 - 1e-9)
        cells = cells[inside]
    if len(cells) > MOST_STARS:
        raise DesignError("border", f"must hold at most {MOST_STARS} stars", f"{len(cells)} stars")
    x, y = lattice.place(cells).T
    distance = np.round(np.hypot(x, y) / lattice.spacing_mm, 6)
    angle = np.round(np.arctan2(y, x), 6) % round(2 * np.pi, 6)  # a star on the axis is first whatever its rounding
    return cells[np.lexsort((angle, distance))]


def _box(corners: Floats) -> tuple[Floats, Floats]:
    return corners.min(axis=0), corners.max(axis=0)


def _check_count(lattice: Lattice, corners: Floats) -> None:
    """Refuse before a lattice of millions is listed: of the sheet, or of the box around it."""
    low, high = _box(corners)
    cell = abs(np.linalg.det(lattice.vectors))
    cells = float(shapely.area(shapely.polygons(corners))) / cell
    if cells > 20 * MOST_STARS or np.prod(high - low) / cell > MOST_LISTED:
        raise DesignError("border", f"must hold at most {MOST_STARS} stars", f"room for {cells:.0f} stars")


def _check_polygon(polygon: tuple[Point, ...]) -> None:
    def wrong(allowed: str, value: object = polygon) -> DesignError:
        return DesignError("polygon_mm", allowed, value)

    corners = np.asarray(polygon)
    if np.abs(corners).max() > LARGEST_MM:
        raise wrong(f"must be within {LARGEST_MM:g} mm of the origin")
    step = np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    if step.min() < 1e-3:
        again = polygon[(int(step.argmin()) + 1) % len(polygon)]
        raise wrong("must not repeat a corner (nor the first at the end)", again)
    sheet = shapely.polygons(corners)
    if not shapely.is_valid(sheet):
        raise wrong("must not cross or touch itself")
    if shapely.area(sheet) < 1:
        raise wrong("must enclose at least 1 mm2")
