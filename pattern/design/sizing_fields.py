"""Sizing fields: a quantity that varies over the sheet."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, field_validator, model_validator

from pattern.design.errors import DesignError
from pattern.design.formula import FormulaError, check, evaluate
from pattern.design.image import Picture
from pattern.design.section import Flag, Number, Point, Section, Text
from pattern.geometry.arrays import Floats

SHORTEST_MM = 1e-6  # from start to end of a gradient: what is nearer is one place
_Distance = Annotated[Number, Field(gt=0, le=1e4)]
_Power = Annotated[Number, Field(gt=0, le=100)]


class _Gradient(Section):
    """Goes from `start` (written `from`) to `end` (written `to`), and stays there."""

    start: Number = Field(alias="from")
    end: Number = Field(alias="to")
    power: _Power = 1.0

    def _between(self, fraction: Floats) -> Floats:
        """Values at fractions of the way; `power` bends the profile."""
        return self.start + (self.end - self.start) * np.clip(fraction, 0, 1) ** self.power


class Radial(_Gradient):
    """From the value at `centre_mm` to the value at the distance `over_mm` and beyond."""

    profile: Literal["radial"]
    over_mm: _Distance
    centre_mm: Point = (0.0, 0.0)

    def values(self, points: Floats) -> Floats:
        """(n,) at the points (n, 2)."""
        return self._between(np.linalg.norm(points - np.asarray(self.centre_mm), axis=1) / self.over_mm)


class Linear(_Gradient):
    """From the value at `start_mm` to the value at `end_mm`, constant across."""

    profile: Literal["linear"]
    start_mm: Point
    end_mm: Point

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        if np.linalg.norm(np.subtract(self.end_mm, self.start_mm)) < SHORTEST_MM:
            raise DesignError("end_mm", "must differ from start_mm", self.end_mm)
        return self

    def values(self, points: Floats) -> Floats:
        """(n,) at the points (n, 2)."""
        way = np.subtract(self.end_mm, self.start_mm)
        return self._between((points - np.asarray(self.start_mm)) @ way / (way @ way))


class Axis(_Gradient):
    """From the value on the middle line to the value at `over_mm` on both sides of it.

    `axis = "x"` varies along x: the distance is |x - centre x|.
    """

    profile: Literal["axis"]
    axis: Literal["x", "y"]
    over_mm: _Distance
    centre_mm: Point = (0.0, 0.0)

    def values(self, points: Floats) -> Floats:
        """(n,) at the points (n, 2)."""
        along = "xy".index(self.axis)
        return self._between(np.abs(points[:, along] - self.centre_mm[along]) / self.over_mm)


class Table(Section):
    """Values over the distance from `centre_mm`, linear between, constant beyond the ends.

    `smooth` puts a monotone cubic through the table instead, which never overshoots its values.
    """

    profile: Literal["table"]
    distance_mm: tuple[Number, ...] = Field(min_length=2, max_length=1000)
    values_: tuple[Number, ...] = Field(alias="values", min_length=2, max_length=1000)
    centre_mm: Point = (0.0, 0.0)
    smooth: Flag = False

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        if len(self.values_) != len(self.distance_mm):
            raise DesignError("values", f"must have {len(self.distance_mm)} entries, one a distance", self.values_)
        if not np.all(np.diff(self.distance_mm) >= 1e-6):
            raise DesignError("distance_mm", "must increase from entry to entry, by 1e-6 or more", self.distance_mm)
        return self

    def values(self, points: Floats) -> Floats:
        """(n,) at the points (n, 2)."""
        distance = np.linalg.norm(points - np.asarray(self.centre_mm), axis=1)
        if self.smooth:
            from scipy.interpolate import PchipInterpolator  # slow to import, rarely used

            inside = np.clip(distance, self.distance_mm[0], self.distance_mm[-1])
            return np.asarray(PchipInterpolator(self.distance_mm, self.values_)(inside))
        return np.interp(distance, self.distance_mm, self.values_)


class Formula(Section):
    """A formula in x, y (mm), r (mm from the origin) and theta (rad from the x axis)."""

    formula: Text

    @field_validator("formula")
    @classmethod
    def _can_be_read(cls, text: str) -> str:
        try:
            check(text)
        except FormulaError as problem:
            raise DesignError("", str(problem), text) from None
        return text

    def values(self, points: Floats) -> Floats:
        """(n,) at the points (n, 2)."""
        x, y = points.T
        return evaluate(self.formula, {"x": x, "y": y, "r": np.hypot(x, y), "theta": np.arctan2(y, x)})


_PROFILES = ("radial", "linear", "axis", "table")


def _kind(value: Any) -> str:
    if isinstance(value, Section):
        return f"kind:{getattr(value, 'profile', type(value).__name__.lower())}"
    if isinstance(value, str):
        return "kind:unknown"
    if not isinstance(value, dict):
        return "kind:number"
    for key in ("formula", "image"):
        if key in value:
            return "kind:picture" if key == "image" else "kind:formula"
    return f"kind:{value['profile']}" if value.get("profile") in _PROFILES else "kind:unknown"


def _refuse(value: Any) -> None:
    if isinstance(value, dict) and "profile" in value:
        raise DesignError("profile", f"must be {', '.join(_PROFILES)}", value["profile"])
    hint = ""
    if isinstance(value, str):
        hint = "; numbers have no quotes" if _is_number(value) else '; a formula is written { formula = "..." }'
    raise DesignError("", f"must be a number, or a table with a profile, a formula or an image{hint}", value)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


SizingField = Annotated[
    Annotated[Number, Tag("kind:number")]
    | Annotated[Radial, Tag("kind:radial")]
    | Annotated[Linear, Tag("kind:linear")]
    | Annotated[Axis, Tag("kind:axis")]
    | Annotated[Table, Tag("kind:table")]
    | Annotated[Formula, Tag("kind:formula")]
    | Annotated[Picture, Tag("kind:picture")]
    | Annotated[Any, BeforeValidator(_refuse), Tag("kind:unknown")],
    Discriminator(_kind),
]


def sample(field: SizingField, points: Floats) -> Floats:
    """(n,) values of a field at the points (n, 2)."""
    if isinstance(field, float):
        return np.full(len(points), field)
    values: Callable[[Floats], Floats] = field.values
    return values(points)
