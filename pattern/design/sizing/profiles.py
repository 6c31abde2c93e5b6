"""Sizing fields of the design file: a number, or a table with a profile, a quantity that varies over the sheet."""

from __future__ import annotations

import binascii
import zlib
from abc import abstractmethod
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Field,
    PlainValidator,
    SerializeAsAny,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    model_validator,
)

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.errors import DesignError, from_validation
from asterism.pattern.design.section import Flag, Number, Point, Section, Text, Whole, within
from asterism.pattern.design.sizing.expression import checked_expression, evaluate
from asterism.pattern.design.sizing.grey_image import MAX_PIXELS_A_SIDE, ImageError, pack_image, read_grey, unpack_image

DistanceMm = Annotated[Number, Field(gt=0, le=1e4)]
Power = Annotated[Number, Field(gt=0, le=100)]


class Profile(Section):
    """A quantity that varies over the sheet. A new profile is a subclass in `NAMED_PROFILES`."""

    @abstractmethod
    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm."""


class GradientProfile(Profile):
    """Goes from `start` (in the file: `from`) to `end` (`to`), and is constant beyond."""

    start: Number = Field(alias="from")
    end: Number = Field(alias="to")
    power: Power = 1.0

    @abstractmethod
    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm; below 0 or above 1 beyond them."""

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm; `power` bends the profile."""
        return np.asarray(self.start + (self.end - self.start) * np.clip(self.fraction(points), 0, 1) ** self.power)


class AxisProfile(GradientProfile):
    """From the value on the centre line to the value at `over_mm` on both sides of it.

    `axis = "x"` varies along x: the distance is |x - centre x|.
    """

    profile: Literal["axis"]
    axis: Literal["x", "y"]
    over_mm: DistanceMm
    centre_mm: Point = (0.0, 0.0)

    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm."""
        component = "xy".index(self.axis)
        return np.asarray(np.abs(points[:, component] - self.centre_mm[component]) / self.over_mm)


class FormulaProfile(Profile):
    """A formula in x, y (mm), r (mm from the origin) and theta (rad from the x axis).

    >>> FormulaProfile(formula="5 + r/10").at(np.array([[3.0, 4.0]])).tolist()
    [5.5]
    """

    formula: Annotated[Text, AfterValidator(checked_expression)]

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm; not finite where the formula has no value."""
        x, y = points.T
        return evaluate(self.formula, {"x": x, "y": y, "r": np.hypot(x, y), "theta": np.arctan2(y, x)})


class LinearProfile(GradientProfile):
    """From the value at `start_mm` to the value at `end_mm`, constant across."""

    profile: Literal["linear"]
    start_mm: Point
    end_mm: Point

    @model_validator(mode="after")
    def _has_a_direction(self) -> Self:
        if np.linalg.norm(np.subtract(self.end_mm, self.start_mm)) < 1e-6:
            raise DesignError("end_mm", "must differ from start_mm", self.end_mm)
        return self

    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm."""
        way = np.subtract(self.end_mm, self.start_mm)
        return np.asarray((points - np.asarray(self.start_mm)) @ way / (way @ way))


class PictureProfile(Profile):
    """Grey values over a rectangle around `centre_mm`: black is `low`, white is `high`, bilinear between pixels.

    When a design is read, its picture is scaled down to 256 pixels a side, and the grey values are stored in the design
    (`grey`). So a design and its results remain complete without the picture's file. A design with stored grey values
    does not read the file again.
    """

    image: Text  # path relative to the design file
    # low, high: values at black and at white.
    low: Number
    high: Number
    # width and height on the sheet. Points outside have the value of the nearest edge.
    extent_mm: Annotated[Point, within(0.1, 1e4, " mm")]
    centre_mm: Point = (0.0, 0.0)
    # pixels, grey: columns and rows, and the grey values (0-255, rows from the top) compressed as text.
    pixels: tuple[Whole, Whole] | None = None
    grey: Text | None = Field(None, repr=False)

    @model_validator(mode="before")
    @classmethod
    def _read(cls, data: Any, info: ValidationInfo) -> Any:
        if not isinstance(data, dict) or "grey" in data or not isinstance(data.get("image"), str):
            return data
        folder = (info.context or {}).get("folder", Path())
        try:
            grey = read_grey(folder / data["image"])
        except ImageError as problem:
            raise DesignError("image", str(problem), data["image"]) from None
        return {**data, "pixels": grey.shape[::-1], "grey": pack_image(grey)}

    @model_validator(mode="after")
    def _is_complete(self) -> PictureProfile:
        if self.pixels is None or not all(1 <= side <= MAX_PIXELS_A_SIDE for side in self.pixels):
            allowed = f"must be columns and rows, 1 to {MAX_PIXELS_A_SIDE}, with grey"
            raise DesignError("pixels", allowed, self.pixels)
        try:
            self._grey_values()
        except (ValueError, zlib.error, binascii.Error):
            raise DesignError(
                "grey", "does not match the pixels: leave it out to read the image again", "..."
            ) from None
        return self

    def _grey_values(self) -> Floats:
        """(rows, columns) 0 to 1, rows from the top."""
        columns, rows = self.pixels or (0, 0)
        return unpack_image(self.grey or "", rows, columns)

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm."""
        from scipy.ndimage import map_coordinates  # slow to import, rarely used

        grey = self._grey_values()[::-1]  # rows from the bottom, as y counts
        # pixel centres are half a pixel inside the extent
        place = (points - np.asarray(self.centre_mm)) / np.asarray(self.extent_mm) + 0.5
        columns, rows = (place * grey.shape[::-1] - 0.5).T
        between = map_coordinates(grey, [rows, columns], order=1, mode="nearest")
        return np.asarray(self.low + (self.high - self.low) * between)


class RadialProfile(GradientProfile):
    """From the value at `centre_mm` to the value at the distance `over_mm` and beyond.

    >>> radial = RadialProfile.model_validate({"profile": "radial", "from": 10, "to": 4, "over_mm": 30})
    >>> radial.at(np.array([[0.0, 0.0], [15.0, 0.0], [0.0, 60.0]])).tolist()
    [10.0, 7.0, 4.0]
    """

    profile: Literal["radial"]
    over_mm: DistanceMm
    centre_mm: Point = (0.0, 0.0)

    def fraction(self, points: Floats) -> Floats:
        """(n,) part of the way from start to end at the printed points (n, 2) mm."""
        return np.asarray(np.linalg.norm(points - np.asarray(self.centre_mm), axis=1) / self.over_mm)


class TableProfile(Profile):
    """Values over the distance from `centre_mm`, linear between the entries, constant beyond the ends.

    `smooth` puts a monotone cubic through the entries instead. It never exceeds their range.

    >>> table = TableProfile(profile="table", distance_mm=(0.0, 10.0), values=(2.0, 4.0))
    >>> table.at(np.array([[5.0, 0.0], [0.0, 50.0]])).tolist()
    [3.0, 4.0]
    """

    profile: Literal["table"]
    distance_mm: tuple[Number, ...] = Field(min_length=2, max_length=1000)
    values: tuple[Number, ...] = Field(min_length=2, max_length=1000)
    centre_mm: Point = (0.0, 0.0)
    smooth: Flag = False

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        if len(self.values) != len(self.distance_mm):
            raise DesignError("values", f"must have {len(self.distance_mm)} entries, one a distance", self.values)
        if not np.all(np.diff(self.distance_mm) >= 1e-6):
            allowed = "must increase from entry to entry, by 1e-6 or more"
            raise DesignError("distance_mm", allowed, self.distance_mm)
        return self

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm."""
        distance = np.linalg.norm(points - np.asarray(self.centre_mm), axis=1)
        if self.smooth:
            from scipy.interpolate import PchipInterpolator  # slow to import, rarely used

            inside = np.clip(distance, self.distance_mm[0], self.distance_mm[-1])
            return np.asarray(PchipInterpolator(self.distance_mm, self.values)(inside))
        return np.asarray(np.interp(distance, self.distance_mm, self.values))


# by the value of `profile` in a table of the design file
NAMED_PROFILES: dict[Any, type[Profile]] = {
    "axis": AxisProfile,
    "linear": LinearProfile,
    "radial": RadialProfile,
    "table": TableProfile,
}
# by a key of the table, as `{ formula = "..." }`, whatever else is in it
MARKED_PROFILES: dict[str, type[Profile]] = {"formula": FormulaProfile, "image": PictureProfile}
_NUMBER: TypeAdapter[float] = TypeAdapter(Number, config=Section.model_config)


def _read(value: Any, info: ValidationInfo) -> float | Profile:
    """The number or the profile that a value of the design file is."""
    if isinstance(value, Profile):
        return value
    try:
        if not isinstance(value, dict | str):
            return _NUMBER.validate_python(value)
        if isinstance(value, dict):
            marked = [kind for key, kind in MARKED_PROFILES.items() if key in value]
            named = [kind for key, kind in NAMED_PROFILES.items() if key == value.get("profile")]
            for kind in marked or named:
                return kind.model_validate(value, context=info.context)
    except ValidationError as error:
        raise from_validation(error) from None
    if isinstance(value, dict) and "profile" in value:
        raise DesignError("profile", f"must be {', '.join(NAMED_PROFILES)}", value["profile"])
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


SizingField = Annotated[float | SerializeAsAny[Profile], PlainValidator(_read)]


def sample(field: float | Profile, points: Floats) -> Floats:
    """(n,) values of a sizing field at the printed points (n, 2) mm.

    >>> sample(7.5, np.zeros((2, 2))).tolist()
    [7.5, 7.5]
    """
    return field.at(points) if isinstance(field, Profile) else np.full(len(points), field)
