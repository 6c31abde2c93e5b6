"""The rigid motions that pins leave to a sheet."""

from __future__ import annotations

import numpy as np

from pattern.geometry.arrays import Floats
from pattern.layout.layout import Layout
from pattern.layout.pin_places import pin_places

NOTHING = 1e-6  # of the size: a motion of what is held by less is none


def free_turns(layout: Layout) -> Floats:
    """(k, 3) axes of the turns, with or without a shift, that all pins of a layout together leave; orthonormal.

    All three of a free sheet, none where pins say how it lies. Weight is not asked.
    """
    printed, places, _ = pin_places(layout)
    fixed = ~np.isnan(places)
    if not fixed.any():
        return np.eye(3)
    # where they slide, places are about those of the print, at heights that no plane has
    x, y = (printed - printed.mean(axis=0)).T / max(float(np.ptp(printed, axis=0).max()), 1e-9)
    somewhere = np.column_stack([printed, np.ptp(printed) * (0.07 * x**2 + 0.13 * y**2 + 0.09 * x * y)])
    spots = np.where(fixed, places, somewhere)
    arms = spots - spots.mean(axis=0)
    size = max(float(np.abs(arms).max()), 1e-9)
    rows = []
    for (ax, ay, az), held in zip(arms / size, fixed, strict=True):
        # a turn w moves the place by w x arm
        turn = np.array([[0.0, az, -ay], [-az, 0.0, ax], [ay, -ax, 0.0]])
        rows.append(np.hstack([np.eye(3), turn])[held])
    _, sizes, motions = np.linalg.svd(np.concatenate(rows))
    free = motions[np.count_nonzero(sizes > NOTHING) :]
    _, sizes, axes = np.linalg.svd(free[:, 3:])
    return np.asarray(axes[: np.count_nonzero(sizes > NOTHING)])


def tilts(layout: Layout) -> int:
    """About how many axes that are not upright the pins let the sheet turn; only weight says how it lies then."""
    return int(np.linalg.matrix_rank(free_turns(layout)[:, :2], NOTHING))
