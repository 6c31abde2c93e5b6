"""A size of rods over the sheet that is painted with a brush: values on a grid, kept in the design as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, Field
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats
from asterism.pattern.design.section import Point
from asterism.pattern.design.sizing.grey_image import MAX_PIXELS_A_SIDE, pack_image
from asterism.pattern.design.sizing.profiles import SizingField, sample

# values of the design file: readable, and below what a picture resolves
DIGITS = 4


class Brush(BaseModel):
    """What a brush does where it is put down.

    Attributes
    ----------
    mode : draw values towards `value`, add `value` to them, or draw them towards the mean around them.
    radius : mm.
    strength : share of the way in the middle; it falls to zero at the radius.
    value : mm.
    low, high : mm, no value leaves this range.
    """

    mode: Literal["set", "add", "smooth"]
    radius: Annotated[float, Field(ge=0.5, le=1000)]
    strength: Annotated[float, Field(ge=0, le=1)]
    value: Annotated[float, Field(ge=-100, le=100)] = 0.0
    low: Annotated[float, Field(ge=0, le=100)]
    high: Annotated[float, Field(ge=0, le=100)]


@dataclass(frozen=True, eq=False)
class PaintedField:
    """Values on a grid of pixels.

    Attributes
    ----------
    values : (rows, columns) mm, rows from the bottom.
    extent, centre : mm, width and height of all pixels on the sheet, and their middle.
    """

    values: Floats
    extent: Point
    centre: Point

    @classmethod
    def of(cls, size: SizingField, outline: Floats) -> Self:
        """The values of a sizing field on the grid of a sheet.

        Parameters
        ----------
        outline : (n, 2) printed mm.
        """
        low, high = outline.min(axis=0), outline.max(axis=0)
        # values stand 1 mm apart, as places along rods do; further on sheets with more than the most pixels
        columns, rows = np.clip(np.ceil(high - low), 1, MAX_PIXELS_A_SIDE).astype(int)
        extent, centre = np.round(high - low, DIGITS), np.round(0.5 * (low + high), DIGITS)
        blank = cls(np.zeros((rows, columns)), (extent[0], extent[1]), (centre[0], centre[1]))
        return replace(blank, values=sample(size, blank.places).reshape(rows, columns))

    @property
    def places(self) -> Floats:
        """(rows * columns, 2) printed mm, the middles of the pixels."""
        rows, columns = self.values.shape
        x, y = np.meshgrid((np.arange(columns) + 0.5) / columns - 0.5, (np.arange(rows) + 0.5) / rows - 0.5)
        return np.column_stack([x.ravel(), y.ravel()]) * self.extent + self.centre

    def brushed(self, brush: Brush, places: Sequence[Sequence[Point]]) -> Self:
        """The field after the brush was put down several times.

        Parameters
        ----------
        places : printed mm; each time at one place, and at its images under the symmetries.
        """
        values = self.values.ravel().copy()
        pixels = self.places
        for images in places:
            away = cKDTree(np.asarray(images, dtype=float)).query(pixels, distance_upper_bound=brush.radius)[0]
            near = np.flatnonzero(away < brush.radius)
            share = brush.strength * (1.0 - (away[near] / brush.radius) ** 2) ** 2
            if brush.mode == "add":
                change = share * brush.value
            else:
                wanted = brush.value if brush.mode == "set" else self._means(values, brush.radius)[near]
                change = share * (wanted - values[near])
            values[near] = np.clip(values[near] + change, brush.low, brush.high)
        return replace(self, values=values.reshape(self.values.shape))

    def _means(self, values: Floats, radius: float) -> Floats:
        pixel = np.asarray(self.extent)[::-1] / self.values.shape
        return np.asarray(
            # a smoothing brush draws values towards their mean over a Gaussian of this width, over its radius
            gaussian_filter(values.reshape(self.values.shape), 0.5 * radius / pixel, mode="nearest")
        ).ravel()

    @property
    def profile(self) -> dict[str, Any] | float:
        """The field in a design file: a picture with 256 grey values, or a number if it is the same everywhere."""
        low, high = (float(np.round(end, DIGITS)) for end in (self.values.min(), self.values.max()))
        if low == high:
            return low
        grey = np.round(255.0 * np.clip((self.values[::-1] - low) / (high - low), 0.0, 1.0)).astype(np.uint8)
        return {
            # in the place of a picture's file
            "image": "painted in the studio",
            "low": low,
            "high": high,
            "extent_mm": [float(side) for side in self.extent],
            "centre_mm": [float(side) for side in self.centre],
            "pixels": list(grey.shape[::-1]),
            "grey": pack_image(grey),
        }
