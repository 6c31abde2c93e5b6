"""Warnings of supports that stretch the sheet, or that leave its orientation undetermined."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from asterism.pattern.layout.free_motions import count_free_tilts
from asterism.pattern.layout.layout import Layout

# size of the supports in space over their size in print, above which a warning appears
MAX_SIZE_OVER_PRINT = 1.05


def pin_warnings(layout: Layout, weighs: bool) -> Iterator[str]:
    """Yield one line for each warning.

    Parameters
    ----------
    weighs : whether the design includes gravity, which determines how a sheet hangs.
    """
    yield from held_wide(layout)
    if layout.pins and not weighs and (axes := count_free_tilts(layout)):
        about = "a point" if axes > 1 else "a line"
        yield f"the pins let the sheet turn about {about}: its orientation, and with it its height, is arbitrary"


def held_wide(layout: Layout) -> Iterator[str]:
    """Yield a line if the pins pull the sheet wider than it was printed, often by a scale given in percent."""
    printed, places, _ = layout.support_samples
    held = ~np.isnan(places[:, :2]).any(axis=1)
    if not held.any():
        return
    places = np.nan_to_num(places)  # points that slide along z count with height 0
    in_print, in_space = (np.linalg.norm(points[held] - points[held].mean(axis=0)) for points in (printed, places))
    if in_space > MAX_SIZE_OVER_PRINT * in_print > 0.0:
        wide = f"{in_space / in_print:.3g} times as wide as it was printed"
        yield f"the pins hold the sheet {wide}: its fabric is stretched further than on the printer"
