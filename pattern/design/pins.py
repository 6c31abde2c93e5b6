"""The section `[[pins]]`: how the sheet is supported in space."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.section import Number, Place, Point, Section, Whole, within

NearPlace = Annotated[Place, within(-1e4, 1e4, " mm")]


class Pins(Section):
    """Places of the sheet that are all supported in the same way.

    An entry has one of `where`, `points_mm`, `edges`, `corners` and `holes`. `pattern.layout.pin_placement` finds their
    places.
    """

    where: Literal["border", "corners"] | None = None  # "border" or "corners": the whole outline, or all of its corners
    # printed points. Points within 0.25 mm of the outline, of the edge of a hole, of a star's centre, of a tip or of an
    # arm are moved onto it.
    points_mm: tuple[Point, ...] | None = Field(None, min_length=1, max_length=10000)
    # edges, corners: numbers of edges or corners of the outline, counterclockwise. Edge i runs from corner i to corner
    # i + 1. Corner 0 of a hexagon is at 30 deg, of a rectangle at the lower left.
    edges: tuple[Whole, ...] | None = Field(None, min_length=1, max_length=1000)
    corners: tuple[Whole, ...] | None = Field(None, min_length=1, max_length=1000)
    # numbers of holes whose whole edges are supported: 0 is the first of `border.holes`.
    holes: tuple[Whole, ...] | None = Field(None, min_length=1, max_length=1000)
    # the pins stand at `scale` times the printed place, about the origin, at the height z = 0.
    scale: Number = Field(1.0, ge=1e-3, le=10)
    offset_mm: NearPlace = (0.0, 0.0, 0.0)  # moves the pins from there
    # places of the pins in space, one a point; in place of `scale` and `offset_mm`. For edges that follow each other,
    # one for each of their corners: they are held along a smooth curve through these places.
    target_mm: tuple[NearPlace, ...] | None = None
    slide: Literal["z", "plane"] | None = None  # leaves the sheet free to slide along "z", or in the "plane" z = 0
    # pins of step 0 support the sheet during its release. Pins of steps 1, 2, ... move the released sheet to their
    # places, in this order.
    step: Whole = Field(0, ge=0, le=100)

    @field_validator("target_mm", mode="before")
    @classmethod
    def _single_target(cls, value: Any) -> Any:
        """Accept a single place without the outer list."""
        match value:
            case [float() | int(), *_]:
                return [value]
        return value

    @model_validator(mode="after")
    def _consistent(self) -> Pins:
        self._check_one_of("where", "points_mm", "edges", "corners", "holes")
        if self.target_mm is not None and self.holes is not None:
            raise DesignError("target_mm", "does not go with holes, but scale and offset_mm do", self.target_mm)
        if self.target_mm is not None and (self.scale != 1 or any(self.offset_mm)):
            raise DesignError("target_mm", "stands alone, without scale and offset_mm", self.target_mm)
        if len(self.target_mm or ()) > 1 and len(set(self.target_mm or ())) == 1:
            raise DesignError("target_mm", "must not be one place for all points", self.target_mm)
        return self
