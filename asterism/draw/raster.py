"""Depth buffer: the triangle that is visible at each pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.compiled import loop

# two neighbours may both draw a pixel on their common edge, so that rounding leaves no hole; in pixels
EDGE_TOLERANCE_PX = 1e-6


@dataclass(frozen=True)
class Raster:
    """The visible triangle and its depth at each pixel.

    Attributes
    ----------
    face : (height, width) visible triangle, -1 in the background. Row 0 is the lowest.
    depth : (height, width) depth of that triangle, -inf in the background.
    functions : (3, T, 3), the barycentric weights of a triangle's corners at pixel (x, y):
        `functions[0] x + functions[1] y + functions[2]`.
    """

    face: Ints
    depth: Floats
    functions: Floats

    def affine(self, values: Floats, triangles: Ints) -> Floats:
        """Values (V, m) of the vertices as affine functions of the pixel, like `functions`: (3, T, m)."""
        return np.asarray(np.einsum("ptk,tkm->ptm", self.functions, values[triangles]))


def rasterise(places: Floats, depth: Floats, triangles: Ints, height: int, width: int) -> Raster:
    """Find the nearest triangle at the centre of every pixel.

    Parameters
    ----------
    places : (V, 2) pixels from the lower left corner of the image.
    depth : (V,) larger values are nearer; interpolated linearly on the image.
    triangles : (T, 3).
    height, width : size of the image in pixels.
    """
    functions = _weight_functions(places[triangles])
    depths = np.einsum("ptk,tk->tp", functions, depth[triangles])
    face, nearest = np.full((height, width), -1, dtype=np.int64), np.full((height, width), -np.inf)
    _fill(places[triangles, 1], functions, depths, face, nearest)
    return Raster(face, nearest, functions)


def _weight_functions(corners: Floats) -> Floats:
    """(3, T, 3); zero for triangles seen edge-on, which cover no pixel."""
    following, last = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    across = following[..., 1] - last[..., 1]
    upwards = last[..., 0] - following[..., 0]
    constant = following[..., 0] * last[..., 1] - last[..., 0] * following[..., 1]
    twice_area = constant.sum(axis=1, keepdims=True)
    flat = np.abs(twice_area) < 1e-9
    scale = np.where(flat, 0.0, 1 / np.where(flat, 1.0, twice_area))
    return np.stack([across * scale, upwards * scale, constant * scale])


@loop
def _fill(corner_y, functions, depths, face, nearest):  # type: ignore[no-untyped-def]
    """Write the nearest triangle to face and its depth to nearest, both (height, width).

    corner_y (T, 3), functions (3, T, 3) the weights, depths (T, 3) the depth as `x, y, 1` times its row.
    """
    height, width = face.shape
    for t in range(corner_y.shape[0]):
        if functions[0, t, 0] == 0.0 and functions[0, t, 1] == 0.0 and functions[0, t, 2] == 0.0:
            continue
        low = max(np.ceil(min(corner_y[t, 0], corner_y[t, 1], corner_y[t, 2]) - 0.5), 0.0)
        high = min(np.floor(max(corner_y[t, 0], corner_y[t, 1], corner_y[t, 2]) - 0.5), height - 1.0)
        if not low <= high:
            continue
        for row in range(int(low), int(high) + 1):
            # the part of the row where all three weights are at least zero
            left, right = -np.inf, np.inf
            for k in range(3):
                slope = functions[0, t, k]
                value = functions[1, t, k] * (row + 0.5) + functions[2, t, k]
                if abs(slope) < 1e-12:
                    if value < -1e-9:
                        right = -np.inf
                elif slope > 0:
                    left = max(left, -value / slope)
                else:
                    right = min(right, -value / slope)
            first = np.ceil(max(left - 0.5 - EDGE_TOLERANCE_PX, 0.0))
            last = np.floor(min(right - 0.5 + EDGE_TOLERANCE_PX, width - 1.0))
            if not first <= last:
                continue
            start = depths[t, 1] * (row + 0.5) + depths[t, 2] + 0.5 * depths[t, 0]
            for column in range(int(first), int(last) + 1):
                here = start + depths[t, 0] * column
                if here >= nearest[row, column]:
                    nearest[row, column] = here
                    face[row, column] = t
