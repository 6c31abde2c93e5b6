"""The section `[border]`: the outline of the sheet; with circles and ellipses, which lines of `[rods]` have too."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Literal, Self

import numpy as np
import shapely
from pydantic import Field, field_validator, model_validator

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Line, Number, NumberOrPair, Point, Section, Text, Whole, within
from asterism.pattern.geometry.planar import distance_to_segment

MAX_SHEET_MM = 5000.0
MIN_SHEET_AREA_MM2 = 1.0
# a spike or a slit is thinner than this
MIN_SHEET_WIDTH_MM = 0.01
MAX_HOLES = 1000
# keys of `Border`, one of which has the outline
OUTLINES = ("rings", "rectangle_mm", "polygon_mm", "circle_mm", "spline_mm", "rods")
MAX_BENT = 1000
# of circles and arcs, of the outline and of lines
MIN_RADIUS_MM = 0.5
MAX_RADIUS_MM = 1e4
MAX_ASPECT = 20.0  # of an ellipse


class DrawnCircle(Section):
    """A circle by its centre and radius, or an ellipse by its half axes along x and y in place of the radius.

    >>> ellipse = DrawnCircle(radius=(40.0, 25.0), turn_deg=90.0)
    >>> ellipse.half_axes, ellipse.at(np.zeros(1)).round(9).tolist()
    ((40.0, 25.0), [[0.0, 40.0]])
    """

    centre: Point = (0.0, 0.0)
    radius: NumberOrPair
    turn_deg: Number = Field(0.0, ge=-360, le=360)  # by which the half axes are turned, counterclockwise

    @property
    def half_axes(self) -> tuple[float, float]:
        """mm, along x and y before it is turned."""
        x, y = np.broadcast_to(self.radius, 2)
        return float(x), float(y)

    def at(self, angle: Floats) -> Floats:
        """(n, 2) mm, points by the angle of a circle (n,) rad whose two axes are stretched to the half axes."""
        turn, (a, b) = np.radians(self.turn_deg), self.half_axes
        x, y, c, s = a * np.cos(angle), b * np.sin(angle), np.cos(turn), np.sin(turn)
        return np.asarray(self.centre) + np.column_stack([c * x - s * y, s * x + c * y])

    @property
    def box(self) -> Floats:
        """(2, 2) mm, lower left and upper right corner of the box around it."""
        half = np.hypot(*(self.at(np.array([0.0, np.pi / 2])) - self.centre))
        return np.array([self.centre - half, self.centre + half])

    @field_validator("radius")
    @classmethod
    def _in_range(cls, radius: float | tuple[float, float]) -> float | tuple[float, float]:
        low, high = float(np.min(radius)), float(np.max(radius))
        if not MIN_RADIUS_MM <= low <= high <= MAX_RADIUS_MM:
            raise DesignError("", f"must be from {MIN_RADIUS_MM:g} to {MAX_RADIUS_MM:g}", radius)
        if high > MAX_ASPECT * low:
            raise DesignError("", f"must be half axes of which one is at most {MAX_ASPECT:g} times the other", radius)
        return radius


class Hole(Section):
    """A hole, or several of a drawing: one of `circle_mm`, `polygon_mm`, `spline_mm`, `rods` and `file`.

    >>> Hole(polygon_mm=[(0.0, 0.0), (5.0, 0.0), (0.0, 5.0)]).kind
    'polygon_mm'
    """

    # circle_mm, polygon_mm, bulge_mm, spline_mm: the edge of the hole, as in `Border`.
    circle_mm: DrawnCircle | None = None
    polygon_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=10_000)
    bulge_mm: tuple[Number, ...] | None = None
    spline_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=10_000)
    # name of a closed line of `[rods]` that is the edge: the fabric within it is cut out along its inner edge.
    rods: Line | None = None
    file: Text | None = None  # SVG, DXF or 3DM file. Its closed lines are edges of holes.
    layer: Text | None = None  # of the file; by default all closed lines
    # origin, units: as of `[[rods.import]]`.
    origin: Literal["middle", "drawing"] = "middle"
    units: Literal["mm", "cm", "in", "px", "pt"] | None = None
    # the edges that were read from the file.
    rings_mm: tuple[tuple[Point, ...], ...] = Field((), max_length=MAX_HOLES, repr=False)

    @property
    def kind(self) -> str:
        """Which of the keys has the edge."""
        return next(key for key in _KINDS if getattr(self, key) is not None)

    @model_validator(mode="after")
    def _one_edge(self) -> Self:
        self._check_one_of(*_KINDS)
        _check_bulges(self)
        if self.layer is not None and self.file is None:
            raise DesignError("layer", "goes with file", self.layer)
        return self


_KINDS = ("circle_mm", "polygon_mm", "spline_mm", "rods", "file")


class Border(Section):
    """The outline: one of `rings`, `rectangle_mm`, `polygon_mm`, `circle_mm`, `spline_mm`, `file` and `rods`.

    >>> Border(rectangle_mm=(120.0, 80.0)).overhang
    'cut'
    """

    # hexagon around this many rings of stars about the central one (triangular lattice only).
    rings: Whole | None = Field(None, ge=0, le=40)
    # width and height, centred on the origin
    rectangle_mm: Annotated[Point, within(1, MAX_SHEET_MM, " mm")] | None = None
    # corners in order, clockwise or counterclockwise.
    polygon_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=1000)
    # of each edge, from the first corner on: how far its middle stands out, or in if negative. The edge is an arc.
    bulge_mm: tuple[Number, ...] | None = None
    # a circle or an ellipse; its edges are straight pieces that begin on the x axis.
    circle_mm: DrawnCircle | None = None
    # points that a smooth closed curve passes through.
    spline_mm: tuple[Point, ...] | None = Field(None, min_length=3, max_length=1000)
    # SVG, DXF or 3DM file, whose largest closed line is the outline; closed lines within it are holes. It is read once:
    # the outline is stored as `polygon_mm`, and the holes as `holes`.
    file: Text | None = None
    layer: Text | None = None  # of the file; by default all closed lines
    # `middle` moves the middle of the outline's box to the origin; `drawing` keeps the file's own origin.
    origin: Literal["middle", "drawing"] = "middle"
    units: Literal["mm", "cm", "in", "px", "pt"] | None = None  # unit of a file that gives none
    # name of a closed line of `[rods]` that is the outline: the fabric is cut along its outer edge.
    rods: Line | None = None
    # holes in the sheet; lines and arms are cut there as at the outline.
    holes: tuple[Hole, ...] = Field((), max_length=MAX_HOLES)
    # smallest distance from a star's centre to the outline, unless `rings` gives it, and to holes. By default it is
    # half the spacing, which leaves the outer stars a full cell of fabric.
    star_margin_mm: Number | None = Field(None, ge=1, le=1000)
    # `cut` shortens arms that would leave the sheet, `refuse` reports them as an error.
    overhang: Literal["cut", "refuse"] = "cut"
    tip_margin_mm: Number = Field(0.5, ge=0.1, le=100)  # fabric left between an arm's tip and the outline

    @model_validator(mode="after")
    def _one_outline(self) -> Border:
        self._check_one_of(*OUTLINES)
        for name in ("layer", "units"):
            if self.file is None and getattr(self, name) is not None:
                raise DesignError(name, "goes with file", getattr(self, name))
        if (circle := self.circle_mm) is not None and np.abs(circle.box).max() > MAX_SHEET_MM:
            raise DesignError("circle_mm", f"must be within {MAX_SHEET_MM:g} mm of the origin", circle.model_dump())
        if self.polygon_mm is not None:
            _check_points(np.asarray(self.polygon_mm), "polygon_mm", self.polygon_mm)
            check_ring(np.asarray(self.polygon_mm), "polygon_mm", self.polygon_mm)
        if self.spline_mm is not None:
            _check_points(np.asarray(self.spline_mm), "spline_mm", self.spline_mm)
        _check_bulges(self)
        if self.rings is not None and self.star_margin_mm is not None and not self.holes:
            raise DesignError("star_margin_mm", "goes with another outline, not with rings", self.star_margin_mm)
        if self.star_margin_mm is not None and self.star_margin_mm <= self.tip_margin_mm:
            raise DesignError(
                "star_margin_mm", f"must exceed tip_margin_mm ({self.tip_margin_mm:g})", self.star_margin_mm
            )
        return self

    @property
    def curve_key(self) -> str | None:
        """The key that makes curves between given points."""
        return next((key for key in ("spline_mm", "bulge_mm") if getattr(self, key) is not None), None)


def _check_bulges(edge: Border | Hole) -> None:
    """Refuse bulges that do not belong to the edges of a polygon, and arcs beyond half a circle."""
    if edge.bulge_mm is None:
        return
    if edge.polygon_mm is None:
        raise DesignError("bulge_mm", "goes with polygon_mm", edge.bulge_mm)
    corners, count = np.asarray(edge.polygon_mm), len(edge.polygon_mm)
    if count > MAX_BENT:
        raise DesignError("bulge_mm", f"goes with at most {MAX_BENT} corners", count)
    if len(edge.bulge_mm) != count:
        raise DesignError("bulge_mm", f"must have {count} entries, one for each edge", len(edge.bulge_mm))
    half = 0.5 * np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1)
    # bulges of half a circle may be rounded
    for k in np.flatnonzero(np.abs(edge.bulge_mm) > half + 1e-3):
        allowed = f"must be within {half[k]:g} mm, half the length of its edge: an arc is at most half a circle"
        raise DesignError(f"bulge_mm[{k}]", allowed, edge.bulge_mm[k], place_mm=corners[k])


def _check_points(points: Floats, field: str, value: object) -> None:
    """Refuse points (n, 2) mm that are far away, on one line, or repeated."""
    if np.abs(points).max() > MAX_SHEET_MM:
        raise DesignError(field, f"must be within {MAX_SHEET_MM:g} mm of the origin", value)
    if shapely.area(shapely.convex_hull(shapely.polygons(points))) < MIN_SHEET_AREA_MM2:
        allowed = f"must enclose at least {MIN_SHEET_AREA_MM2:g} mm2: its corners lie on one line"
        raise DesignError(field, allowed, value)
    step = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    if step.min() < 1e-3:
        repeated = tuple(points[(int(step.argmin()) + 1) % len(points)].tolist())
        raise DesignError(field, "must not repeat a corner (nor the first at the end)", repeated, place_mm=repeated)


def check_ring(corners: Floats, field: str, value: object) -> None:
    """Refuse outlines (B, 2) mm that do not bound one piece of fabric.

    Raises `DesignError`; the message names the field and the value.
    """

    def error(allowed: str, place_mm: Iterable[float] | None = None) -> DesignError:
        return DesignError(field, allowed, value, place_mm=place_mm)

    if np.abs(corners).max() > MAX_SHEET_MM:
        raise error(f"must be within {MAX_SHEET_MM:g} mm of the origin")
    sheet = shapely.polygons(corners)
    if not shapely.is_valid(sheet):
        # shapely reports the place in square brackets
        place = shapely.is_valid_reason(sheet).rpartition("[")[2].rstrip("]").split()
        crossing = (float(place[0]), float(place[1])) if len(place) == 2 else None
        at = f", as at [{crossing[0]:.3f}, {crossing[1]:.3f}]" if crossing else ""
        raise error(f"must not cross or touch itself{at}", place_mm=crossing)
    if shapely.area(sheet) < MIN_SHEET_AREA_MM2:
        raise error(f"must enclose at least {MIN_SHEET_AREA_MM2:g} mm2")
    if (corner := _thin_place(corners)) is not None:
        x, y = corners[corner]
        place = f"it has a spike or slit at [{x:g}, {y:g}]"
        raise error(f"must be at least {MIN_SHEET_WIDTH_MM:g} mm wide everywhere: {place}", place_mm=corners[corner])


def _thin_place(corners: Floats) -> int | None:
    """Number of a corner at which the sheet, or the space beside it, is much thinner than it is long."""
    ends = np.roll(corners, -1, axis=0)
    length = np.linalg.norm(ends - corners, axis=1)
    along = np.concatenate([[0.0], np.cumsum(length)])
    edges = shapely.STRtree(shapely.linestrings(np.stack([corners, ends], axis=1)))
    corner, edge = edges.query(shapely.points(corners), predicate="dwithin", distance=MIN_SHEET_WIDTH_MM)
    distance = distance_to_segment(corners[corner], corners[edge], ends[edge])
    # way along the outline to the nearer end of the edge, in either direction; it is 0 to the two edges that end here
    ahead = (along[edge] - along[corner]) % along[-1]
    way = np.minimum(ahead, along[-1] - ahead - length[edge])
    # and much longer
    thin = (distance < MIN_SHEET_WIDTH_MM) & (way > 20.0 * MIN_SHEET_WIDTH_MM)
    return int(corner[thin].min()) if thin.any() else None
