"""Sizes from the grey values of a picture."""

from __future__ import annotations

import binascii
import zlib
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from pydantic import Field, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.section import Number, Point, Text, Whole
from asterism.pattern.design.sizing.grey_image import MAX_PIXELS_A_SIDE, ImageError, pack_image, read_grey, unpack_image
from asterism.pattern.design.sizing.profile import Profile


class PictureProfile(Profile):
    """Grey values over a rectangle around `centre_mm`: black is `low`, white is `high`, bilinear between pixels.

    When a design is read, its picture is scaled down to 256 pixels a side, and the grey values are stored in the design
    (`grey`). So a design and its results remain complete without the picture's file. A design with stored grey values
    does not read the file again.

    Attributes
    ----------
    image : path relative to the design file.
    low, high : values at black and at white.
    extent_mm : width and height on the sheet. Points outside have the value of the nearest edge.
    pixels, grey : columns and rows, and the grey values (0-255, rows from the top) compressed as text.
    """

    key: ClassVar[str] = "image"
    is_marked_by_key: ClassVar[bool] = True
    image: Text
    low: Number
    high: Number
    extent_mm: Point
    centre_mm: Point = (0.0, 0.0)
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
            raise _error("image", str(problem), data["image"]) from None
        return {**data, "pixels": grey.shape[::-1], "grey": pack_image(grey)}

    @model_validator(mode="after")
    def _is_complete(self) -> PictureProfile:
        if not all(0.1 <= size <= 1e4 for size in self.extent_mm):
            raise _error("extent_mm", "must be a width and a height from 0.1 to 10000 mm", self.extent_mm)
        if self.pixels is None or not all(1 <= side <= MAX_PIXELS_A_SIDE for side in self.pixels):
            allowed = f"must be columns and rows, 1 to {MAX_PIXELS_A_SIDE}, with grey"
            raise _error("pixels", allowed, self.pixels)
        try:
            self._grey_values()
        except (ValueError, zlib.error, binascii.Error):
            raise _error("grey", "does not match the pixels: leave it out to read the image again", "...") from None
        return self

    def _grey_values(self) -> Floats:
        """(rows, columns) 0 to 1, rows from the top."""
        columns, rows = self.pixels or (0, 0)
        return unpack_image(self.grey or "", rows, columns)

    def at(self, points: Floats) -> Floats:
        """(n,) values at the printed points (n, 2) mm."""
        grey = self._grey_values()[::-1]  # rows from the bottom, as y counts
        size = np.array(grey.shape[::-1])
        # pixel centres are half a pixel inside the extent
        place = (points - np.asarray(self.centre_mm)) / np.asarray(self.extent_mm) + 0.5
        column, row = np.clip(place * size - 0.5, 0, size - 1).T
        i, j = np.minimum(row.astype(int), size[1] - 1), np.minimum(column.astype(int), size[0] - 1)
        up, right = np.minimum(i + 1, size[1] - 1), np.minimum(j + 1, size[0] - 1)
        u, v = column - j, row - i
        below = (1 - u) * grey[i, j] + u * grey[i, right]
        above = (1 - u) * grey[up, j] + u * grey[up, right]
        return np.asarray(self.low + (self.high - self.low) * ((1 - v) * below + v * above))


def _error(key: str, allowed: str, value: Any) -> PydanticCustomError:
    return PydanticCustomError("picture", "{allowed}", {"allowed": allowed, "key": key, "value": value})
