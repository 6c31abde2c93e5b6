"""What to know of the pins of a sheet before trusting its shape, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pattern.layout.free_rotations import count_free_tilts
from pattern.layout.layout import Layout
from pattern.layout.support_samples import support_samples

MAX_SIZE_OVER_PRINT = 1.05  # times the printed size


def pin_warnings(layout: Layout, weighs: bool) -> Iterator[str]:
    """One line each; `weighs`: the sheet has weight, which says how it hangs."""
    yield from held_wide(layout)
    if layout.pins and not weighs and (axes := count_free_tilts(layout)):
        about = "a point" if axes > 1 else "a line"
        yield f"the pins let the sheet turn about {about}: how it lies, and so how high it is, is chance"


def held_wide(layout: Layout) -> Iterator[str]:
    """Pins that pull the sheet wider than it was printed: mostly a slip, such as a scale in percent."""
    printed, places, _ = support_samples(layout)
    held = ~np.isnan(places[:, :2]).any(axis=1)
    if not held.any():
        return
    places = np.nan_to_num(places)  # what slides along z is as wide as along the print
    before, after = (np.linalg.norm(points[held] - points[held].mean(axis=0)) for points in (printed, places))
    if after > MAX_SIZE_OVER_PRINT * before > 0.0:
        wide = f"{after / before:.3g} times as wide as it was printed"
        yield f"the pins hold the sheet {wide}: its fabric is stretched further than on the printer"
