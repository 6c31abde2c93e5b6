"""Circular arcs and their bounding boxes, all in mm and 1/mm.

The width of the box runs along the chord of the arc; its height is the height of the arc above the chord. Up to a half
circle the width is the chord; beyond, it is the diameter.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from asterism.equilibrium.arrays import Floats


def curvature(width: ArrayLike, height: ArrayLike) -> Floats:
    """(n,) curvature of the arc in a box: `8 H / (W^2 + 4 H^2)` up to a half circle, `2 / W` beyond."""
    w, h = np.asarray(width, dtype=float), np.asarray(height, dtype=float)
    return np.where(2 * h <= w, 8 * h / (w**2 + 4 * h**2), 2 / w)


def box(curvature: ArrayLike, length: ArrayLike) -> tuple[Floats, Floats]:
    """Width and height of the box of an arc, up to a full circle; the sign of the curvature does not matter."""
    k, length = np.broadcast_arrays(np.abs(np.asarray(curvature, dtype=float)), np.asarray(length, dtype=float))
    half = np.minimum(k * length / 2, np.pi)
    # sinc is exact for flat arcs
    chord = length * np.sinc(half / np.pi)
    height = length * half / 4 * np.sinc(half / 2 / np.pi) ** 2
    return np.where(half <= np.pi / 2, chord, 2 / np.maximum(k, 1e-300)), height


def arc_length(width: ArrayLike, height: ArrayLike) -> Floats:
    """(n,) length of the arc in a box."""
    w, h = np.asarray(width, dtype=float), np.asarray(height, dtype=float)
    k = curvature(w, h)
    beyond = 2 / np.maximum(k, 1e-300) * np.arccos(np.clip(1 - h * k, -1, 1))
    half_angle = 2 * np.arctan2(2 * h, w)
    return np.where(2 * h > w, beyond, np.where(h > 0, w * half_angle / np.maximum(np.sin(half_angle), 1e-300), w))


def line_box(width: float, height: float, thickness: float) -> tuple[float, float]:
    """Box of the middle line of a strip from the box around the whole strip.

    The outer side of the strip has the radius `R + t/2`; its inner corners lie at `R - t/2`. If the box is at most as
    high as the thickness, the strip is flat: height 0. ValueError if the box is too small for this thickness.
    """
    if width <= 4 * thickness:
        raise ValueError(f"a strip {thickness:g} mm thick does not bend in a box {width:g} mm wide")
    if height <= thickness:
        return width, 0.0
    if height >= width / 2:
        return width - thickness, height * (width - thickness) / width

    def too_high(half: float) -> float:
        return float(width / 2 * np.tan(half / 2) + thickness * np.cos(half) - height)

    half = float(brentq(too_high, 0.0, np.pi / 2))
    radius = width / (2 * np.sin(half)) - thickness / 2
    return 2 * radius * np.sin(half), radius * (1 - np.cos(half))
