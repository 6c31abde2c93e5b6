"""Depth buffer in numpy: the triangle that is visible at each pixel."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from equilibrium.arrays import Floats, Ints

# work is done in pieces, because the allocation of large temporary arrays would take longer than the work itself
# pairs of a triangle and a pixel in one piece
FRAGMENTS_PER_PIECE = 100_000
# pixels in one piece
PIXELS_PER_PIECE = 20_000


@dataclass(frozen=True)
class Raster:
    """The visible triangle and its depth at each pixel.

    Attributes
    ----------
    face : (height, width) visible triangle, -1 in the background. Row 0 is the lowest.
    depth : (height, width) depth of that triangle, -inf in the background.
    pixels : (P,) flat indices of the pixels that show a triangle.
    functions : three arrays (T, 3), the barycentric weights of a triangle's corners at pixel (x, y):
        `functions[0] x + functions[1] y + functions[2]`.
    """

    face: Ints
    depth: Floats
    pixels: Ints
    functions: tuple[Floats, Floats, Floats]

    def affine(self, values: Floats, triangles: Ints) -> tuple[Floats, Floats, Floats]:
        """Values (V, m) of the vertices as affine functions of the pixel, like `functions`: three arrays (T, m)."""
        across, upwards, constant = (np.einsum("tk,tkm->tm", part, values[triangles]) for part in self.functions)
        return across, upwards, constant

    def at_pixels(self, affine: tuple[Floats, Floats, Floats]) -> Floats:
        """(P, m) values of affine functions at the pixels that show a triangle."""
        seen = self.face.ravel()[self.pixels]
        row, column = np.divmod(self.pixels, self.face.shape[1])
        across, upwards, constant = affine
        values = across[seen]
        values *= (column + 0.5)[:, None]
        values += upwards[seen] * (row + 0.5)[:, None]
        values += constant[seen]
        return values

    def pieces(self) -> Iterator[Raster]:
        """Yield the same raster with one piece of the pixels at a time."""
        for first in range(0, len(self.pixels), PIXELS_PER_PIECE):
            yield replace(self, pixels=self.pixels[first : first + PIXELS_PER_PIECE])


def rasterise(places: Floats, depth: Floats, triangles: Ints, height: int, width: int) -> Raster:
    """Find the nearest triangle at the centre of every pixel.

    Parameters
    ----------
    places : (V, 2) pixels from the lower left corner of the image.
    depth : (V,) larger values are nearer; interpolated linearly on the image.
    triangles : (T, 3).
    height, width : size of the image in pixels.
    """
    # weights of the three corners are affine in the pixel: `across x + upwards y + constant`
    across, upwards, constant = _weight_functions(places[triangles])
    weighted = depth[triangles]
    depth_across = (across * weighted).sum(axis=1)
    depth_upwards = (upwards * weighted).sum(axis=1)
    depth_constant = (constant * weighted).sum(axis=1)
    nearest = np.full(height * width, -np.inf)
    face = np.full(height * width, -1, dtype=np.int64)

    triangle, row = _rows(places[triangles, 1], np.abs(across).sum(axis=1) > 0, height)
    first, count = _columns(across[triangle], upwards[triangle] * (row + 0.5)[:, None] + constant[triangle], width)
    some = count > 0
    triangle, row, first, count = triangle[some], row[some], first[some], count[some]
    groups = np.cumsum(count) // FRAGMENTS_PER_PIECE
    for strips in np.split(np.arange(len(count)), np.flatnonzero(np.diff(groups)) + 1):
        lengths = count[strips]
        begins = np.cumsum(lengths) - lengths
        column = np.arange(lengths.sum()) + np.repeat(first[strips] - begins, lengths)
        of = triangle[strips]
        at_start = depth_upwards[of] * (row[strips] + 0.5) + depth_constant[of] + 0.5 * depth_across[of]
        here = np.repeat(at_start, lengths) + np.repeat(depth_across[of], lengths) * column
        pixel = np.repeat(row[strips] * width, lengths) + column
        np.maximum.at(nearest, pixel, here)
        wins = here == nearest[pixel]
        face[pixel[wins]] = np.repeat(of, lengths)[wins]

    pixels = np.flatnonzero(face >= 0)
    functions = across, upwards, constant
    return Raster(face.reshape(height, width), nearest.reshape(height, width), pixels, functions)


def _weight_functions(corners: Floats) -> tuple[Floats, Floats, Floats]:
    """Three arrays (T, 3); zero for triangles seen edge-on, which cover no pixel."""
    following, last = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    across = following[..., 1] - last[..., 1]
    upwards = last[..., 0] - following[..., 0]
    constant = following[..., 0] * last[..., 1] - last[..., 0] * following[..., 1]
    twice_area = constant.sum(axis=1, keepdims=True)
    flat = np.abs(twice_area) < 1e-9
    scale = np.where(flat, 0.0, 1 / np.where(flat, 1.0, twice_area))
    return across * scale, upwards * scale, constant * scale


def _rows(corner_y: Floats, drawn: np.ndarray, height: int) -> tuple[Ints, Ints]:
    """Pairs of a triangle and a row of pixel centres that it crosses."""
    low = np.clip(np.ceil(corner_y.min(axis=1) - 0.5), 0, height).astype(np.int64)
    high = np.clip(np.floor(corner_y.max(axis=1) - 0.5), -1, height - 1).astype(np.int64)
    counts = np.where(drawn, np.maximum(high - low + 1, 0), 0)
    triangle = np.repeat(np.arange(len(counts)), counts)
    begins = np.cumsum(counts) - counts
    return triangle, np.arange(len(triangle)) + np.repeat(low - begins, counts)


def _columns(slope: Floats, constant: Floats, width: int) -> tuple[Ints, Ints]:
    """First pixel and number of pixels in a row where all three weights `slope x + constant` are at least zero."""
    level = np.abs(slope) < 1e-12
    crossing = -constant / np.where(level, 1.0, slope)
    left = np.where(level | (slope < 0), -np.inf, crossing).max(axis=1)
    right = np.where(level | (slope > 0), np.inf, crossing).min(axis=1)
    # two neighbours may both draw a pixel on their common edge, so that rounding leaves no hole
    first = np.ceil(np.clip(left - 0.5 - 1e-6, 0, width)).astype(np.int64)
    last = np.floor(np.clip(right - 0.5 + 1e-6, -1, width - 1)).astype(np.int64)
    outside = (level & (constant < -1e-9)).any(axis=1)
    return first, np.where(outside, 0, np.maximum(last - first + 1, 0))
