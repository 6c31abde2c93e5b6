"""A picture as a sizing field: dark and light stand for two values."""

from __future__ import annotations

import base64
import binascii
import warnings
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import Field, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from pattern.design.section import Number, Point, Section, Text, Whole
from pattern.geometry.arrays import Floats

MOST_PIXELS = 256
_LARGEST_FILE = 50_000_000
_MOST_SOURCE_PIXELS = 80_000_000


class Picture(Section):
    """Grey values over a rectangle around `centre_mm`: black is `low`, white is `high`, bilinear between pixels.

    On reading, the picture is scaled down to 256 pixels a side and its grey values are kept in the design
    (`grey`), so that a design and its results stay whole when the file is gone. A design that has them
    does not look at the file any more.

    Attributes
    ----------
    image : path relative to the design file.
    extent_mm : width and height on the sheet; points outside take the value of the nearest edge.
    pixels, grey : columns and rows, and the grey values (0-255, rows from the top) compressed as text.
    """

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
            grey = _grey_values(folder / data["image"])
        except _Unreadable as problem:
            raise _wrong("image", str(problem), data["image"]) from None
        return {**data, "pixels": grey.shape[::-1], "grey": _packed(grey)}

    @model_validator(mode="after")
    def _is_whole(self) -> Picture:
        if not all(0.1 <= size <= 1e4 for size in self.extent_mm):
            raise _wrong("extent_mm", "must be a width and a height from 0.1 to 10000 mm", self.extent_mm)
        if self.pixels is None or not all(1 <= side <= MOST_PIXELS for side in self.pixels):
            raise _wrong("pixels", f"must be columns and rows, 1 to {MOST_PIXELS}, with grey", self.pixels)
        try:
            self._greys()
        except (ValueError, zlib.error, binascii.Error):
            raise _wrong("grey", "does not hold the pixels, leave it out to read the image again", "...") from None
        return self

    def _greys(self) -> Floats:
        columns, rows = self.pixels or (0, 0)
        packed = base64.b64decode(self.grey or "", validate=True)
        raw = zlib.decompressobj().decompress(packed, MOST_PIXELS**2)  # bounded, whatever the text claims to hold
        return np.frombuffer(raw, dtype=np.uint8).reshape(rows, columns) / 255

    def values(self, points: Floats) -> Floats:
        """(n,) at the points (n, 2)."""
        grey = self._greys()[::-1]  # rows from the bottom, as y counts
        size = np.array(grey.shape[::-1])
        # pixel centres are half a pixel inside the extent
        at = (points - np.asarray(self.centre_mm)) / np.asarray(self.extent_mm) + 0.5
        column, row = np.clip(at * size - 0.5, 0, size - 1).T
        i, j = np.minimum(row.astype(int), size[1] - 1), np.minimum(column.astype(int), size[0] - 1)
        up, right = np.minimum(i + 1, size[1] - 1), np.minimum(j + 1, size[0] - 1)
        u, v = column - j, row - i
        below = (1 - u) * grey[i, j] + u * grey[i, right]
        above = (1 - u) * grey[up, j] + u * grey[up, right]
        return self.low + (self.high - self.low) * ((1 - v) * below + v * above)


class _Unreadable(Exception):
    pass


def _grey_values(path: Path) -> np.ndarray:
    """(rows, columns) 0-255, at most 256 a side."""
    from PIL import Image, ImageOps, UnidentifiedImageError  # slow to import, rarely used

    try:
        if not path.is_file():
            raise _Unreadable(
                "must be a file" if path.is_dir() else f"there is no such file in {path.parent.absolute()}"
            )
        if path.stat().st_size > _LARGEST_FILE:
            raise _Unreadable(f"must be at most {_LARGEST_FILE // 1_000_000} MB")
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path) as picture:
                if picture.width * picture.height > _MOST_SOURCE_PIXELS:
                    raise Image.DecompressionBombError
                # a photograph may be stored turned, and say so
                flat = ImageOps.exif_transpose(_eight_bits(picture)).convert("RGBA")
        page = Image.new("RGBA", flat.size, "white")  # what is transparent is paper
        page.alpha_composite(flat)
        grey = page.convert("L")
        grey.thumbnail((MOST_PIXELS, MOST_PIXELS), Image.Resampling.BOX)
        return np.asarray(grey)
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        raise _Unreadable("has too many pixels") from None
    except (OSError, ValueError, SyntaxError, UnidentifiedImageError):
        raise _Unreadable("is not a picture that can be read (PNG, JPEG, ...)") from None


def _eight_bits(picture: Any) -> Any:
    """A grey picture of 16 bits a pixel with 8; others as they are."""
    from PIL import Image

    if picture.mode == "F":
        raise _Unreadable("has numbers in place of grey values: save it with 8 or 16 bits a pixel")
    if not picture.mode.startswith("I"):
        return picture
    values = np.asarray(picture, dtype=float)
    if picture.mode == "I" and picture.format != "PNG":  # which numbers are black and white is not said
        raise _Unreadable("has 32 bits a pixel: save it with 8 or 16")
    reduced = Image.fromarray(np.round(values * (255 / 65535)).astype(np.uint8))
    reduced.info = picture.info  # how it is turned
    return reduced


def _packed(grey: np.ndarray) -> str:
    return base64.b64encode(zlib.compress(grey.tobytes(), 9)).decode("ascii")


def _wrong(key: str, allowed: str, value: Any) -> PydanticCustomError:
    return PydanticCustomError("picture", "{allowed}", {"allowed": allowed, "key": key, "value": value})
