"""Pins that pull the sheet wider than it was printed, in words: mostly a slip, such as a scale in percent."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pattern.layout import Layout
from pattern.pin_places import pin_places

WIDER = 1.05  # times the printed size


def held_wide(layout: Layout) -> Iterator[str]:
    """A line, if what is held in all directions is so far apart."""
    printed, places, _ = pin_places(layout)
    held = ~np.isnan(places).any(axis=1)
    if not held.any():
        return
    before, after = (np.linalg.norm(points[held] - points[held].mean(axis=0)) for points in (printed, places))
    if after > WIDER * before > 0.0:
        wide = f"{after / before:.3g} times as wide as it was printed"
        yield f"the pins hold the sheet {wide}: its fabric is stretched further than on the printer"
