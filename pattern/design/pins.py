"""How the sheet is held in space."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
import shapely
from pydantic import Field, field_validator, model_validator

from pattern.design.errors import DesignError
from pattern.design.section import Number, Place, Point, Section, Whole
from pattern.geometry.arrays import Floats
from pattern.layout.layout import PinSet


class Pins(Section):
    """Places of the sheet, all held in the same way.

    Which, one of: `where` = "border" or "corners" (all of them), `points_mm`, or the numbers of `edges` or
    `corners` (counterclockwise; edge i runs from corner i to corner i + 1; corner 0 of a hexagon is at
    30 deg, of a rectangle at the lower left). Points within .25 mm of the outline, of a star's centre, of a tip or of
    an arm are on it.

    How: where it was printed, at `scale` times that place about the origin, moved by `offset_mm`, from the
    height z = 0; or at `target_mm`. `slide` leaves it free along "z", or in the ground "plane".

    When: `step` 0 holds the sheet while it is released; steps 1, 2, ... move the released sheet to its pins, in order.
    """

    where: Literal["border", "corners"] | None = None
    points_mm: tuple[Point, ...] | None = Field(None, min_length=1, max_length=10000)
    edges: tuple[Whole, ...] | None = Field(None, min_length=1, max_length=1000)
    corners: tuple[Whole, ...] | None = Field(None, min_length=1, max_length=1000)
    scale: Number = Field(1.0, ge=1e-3, le=10)
    offset_mm: Place = (0.0, 0.0, 0.0)
    target_mm: tuple[Place, ...] | None = None
    slide: Literal["z", "plane"] | None = None
    step: Whole = Field(0, ge=0, le=100)

    @field_validator("target_mm", mode="before")
    @classmethod
    def _one_target(cls, value: Any) -> Any:
        """A single place may be written without the outer list."""
        match value:
            case [float() | int(), *_]:
                return [value]
        return value

    @model_validator(mode="after")
    def _one_place_one_way(self) -> Pins:
        self._check_one_of("where", "points_mm", "edges", "corners")
        if self.target_mm is not None:
            if self.where == "border" or self.edges is not None:
                raise DesignError(
                    "target_mm", "goes with points or corners; edges take scale or offset_mm", self.target_mm
                )
            if self.scale != 1 or any(self.offset_mm):
                raise DesignError("target_mm", "stands alone, without scale and offset_mm", self.target_mm)
        far = [*self.offset_mm, *(c for place in self.target_mm or () for c in place)]
        if max(map(abs, far)) > 1e4:
            raise DesignError(
                "target_mm" if self.target_mm else "offset_mm", "must be within 10000 mm", max(far, key=abs)
            )
        return self


ON_MM = 0.25  # closer places are one: so far a pin is from the outline, and from other pins
_FIXED = {None: (True, True, True), "z": (True, True, False), "plane": (False, False, True)}


def pin_set(pins: Pins, corners: Floats, name: str) -> PinSet:
    """The pin set on the outline `corners` (B, 2)."""
    count = len(corners)
    points: Floats = np.empty((0, 2))
    edges: tuple[int, ...] = ()
    if pins.where == "border":
        edges = tuple(range(count))
    elif pins.edges is not None:
        edges = _numbers(pins.edges, count, f"{name}.edges")
    elif pins.points_mm is not None:
        points = _taken_to_outline(np.asarray(pins.points_mm), corners, f"{name}.points_mm")
    else:
        chosen = pins.corners if pins.corners is not None else tuple(range(count))
        points = corners[list(_numbers(chosen, count, f"{name}.corners"))]
    target = None
    if pins.target_mm is not None:
        target = np.asarray(pins.target_mm)
        if len(target) != len(points):
            raise DesignError(f"{name}.target_mm", f"must have {len(points)} places, one a point", pins.target_mm)
    return PinSet(points, edges, _FIXED[pins.slide], pins.scale, pins.offset_mm, target, pins.step)


def _numbers(numbers: tuple[int, ...], count: int, field: str) -> tuple[int, ...]:
    for k, number in enumerate(numbers):
        if not 0 <= number < count:
            raise DesignError(f"{field}[{k}]", f"must be from 0 to {count - 1}", number)
        if number in numbers[:k]:
            raise DesignError(f"{field}[{k}]", "must not be listed twice", number)
    return numbers


def _taken_to_outline(points: Floats, corners: Floats, field: str) -> Floats:
    """Points (P, 2) on the sheet; those beside a corner or a side, as written with few digits, are taken to it.

    A needle is thicker than that, and no mesh has good triangles in between.
    """
    near = max(ON_MM, 1e-6 * float(np.ptp(corners, axis=0).max()))
    places = shapely.points(points)
    away = shapely.distance(shapely.polygons(corners), places) > near
    if away.any():
        k = int(away.argmax())
        raise DesignError(f"{field}[{k}]", "must be on the sheet", pair(points[k]))
    ring = shapely.linearrings(corners)
    beside = shapely.distance(ring, places) <= near
    on = shapely.get_coordinates(shapely.line_interpolate_point(ring, shapely.line_locate_point(ring, places)))
    far = np.linalg.norm(points[:, None] - corners, axis=2)
    corner = corners[far.argmin(axis=1)]
    return np.where((far.min(axis=1) <= near)[:, None], corner, np.where(beside[:, None], on, points))


def taken_to_arms(pins: PinSet, corners: Floats, centres: Floats, tips: Floats) -> PinSet:
    """The same pins, points beside a star's centre, a tip or an arm taken to it; those on the outline stay.

    Parameters
    ----------
    corners : (B, 2) mm, of the outline.
    centres, tips : (A, 2) mm, both ends of every arm.
    """
    if not len(pins.points):
        return pins
    places = shapely.points(pins.points)
    off = shapely.distance(shapely.linearrings(corners), places) > 1e-6 * float(np.ptp(corners, axis=0).max())
    ends = np.concatenate([centres, tips])
    end = ends[shapely.STRtree(shapely.points(ends)).nearest(places)]
    at_end = np.linalg.norm(pins.points - end, axis=1) <= ON_MM
    arms = shapely.linestrings(np.stack([centres, tips], axis=1))
    arm = arms[shapely.STRtree(arms).nearest(places)]
    foot = shapely.get_coordinates(shapely.line_interpolate_point(arm, shapely.line_locate_point(arm, places)))
    beside = off & (shapely.distance(arm, places) <= ON_MM)
    taken = np.where(at_end[:, None], end, foot)
    return replace(pins, points=np.where(beside[:, None], taken, pins.points))


def pair(point: Floats) -> list[float]:
    """A place as messages show it."""
    return [round(float(c), 4) for c in point]
