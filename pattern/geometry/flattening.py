"""Curves as polylines: pieces that are close enough to the curve, and that turn little."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from jaxtyping import Float

# a piece of a curve turns by less than this, well below the angle that counts as a corner
MAX_PIECE_TURN_RAD = np.radians(4.0)


def flattened(
    curve: Callable[[Float[np.ndarray, " k"]], Float[np.ndarray, "k 2"]],
    samples: Float[np.ndarray, " s"],
    curve_mm: float,
) -> Float[np.ndarray, "n 2"]:
    """(n, 2) points on a curve from its first to its last parameter.

    Parameters
    ----------
    curve : points (k, 2) at parameters (k,).
    samples : (s,) increasing parameters, so dense that the curve is nearly straight between them.
    curve_mm : largest distance of the curve from the polyline, in the unit of the curve.

    >>> quarter = lambda t: 10.0 * np.column_stack([np.cos(t), np.sin(t)])
    >>> len(flattened(quarter, np.linspace(0.0, np.pi / 2, 100), 1.0))  # 90 degrees in pieces of 4
    28
    """
    places = curve(samples)
    # numbers beyond reason have no use for more points
    curve_mm = max(curve_mm, 1e-8 * float(np.ptp(places, axis=0).max()))
    step = np.diff(places, axis=0)
    length = np.linalg.norm(step, axis=1)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    middle = 0.5 * (length[1:] + length[:-1])
    turn = np.abs(np.diff(heading))
    # pieces of each sample's stretch: by the sagitta of a chord, k s^2/8, and by the turn of a piece
    inner = np.maximum(np.sqrt(turn * middle / (8.0 * curve_mm)), turn / MAX_PIECE_TURN_RAD)
    passed = np.concatenate([[0.0], np.cumsum(np.concatenate([inner[:1], 0.5 * (inner[1:] + inner[:-1]), inner[-1:]]))])
    # a few pieces more than constant curvature would need
    count = max(int(np.ceil(1.2 * passed[-1])), 1)
    if passed[-1] <= 0.0:
        return places[[0, -1]]
    at = np.interp(np.linspace(0.0, passed[-1], count + 1), passed, samples)
    at[[0, -1]] = samples[[0, -1]]
    return np.asarray(curve(at))


def flattened_spline(
    curve: Callable[[Float[np.ndarray, " k"]], Float[np.ndarray, "k 2"]],
    knots: Float[np.ndarray, " s"],
    curve_mm: float,
) -> Float[np.ndarray, "n 2"]:
    """(n, 2) points on a curve with corners at some of its knots, which increase; points repeat at inner knots."""
    # the turn of a span between two knots is measured at so many points
    spans = (np.linspace(start, end, 25) for start, end in pairwise(knots))
    return np.concatenate([flattened(curve, samples, curve_mm) for samples in spans])
