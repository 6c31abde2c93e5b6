"""Pins that pull the sheet wider than it was printed, in words: mostly a slip, such as a scale in percent."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from pattern.layout import Layout

WIDER = 1.05  # times the printed size


def held_wide(layout: Layout) -> Iterator[str]:
    """A line, if what is held in all directions is so far apart."""
    border, printed, places = layout.border, [], []
    for pin in layout.pins:
        if all(pin.fixed):
            ends = sorted({end for edge in pin.edges for end in (edge, (edge + 1) % len(border))})
            points = np.concatenate([np.reshape(pin.points, (-1, 2)), border[ends].reshape(-1, 2)])
            printed.append(points)
            places.append(pin.places(points))
    if not printed:
        return
    before, after = (np.concatenate(parts) for parts in (printed, places))
    sizes = [np.linalg.norm(points - points.mean(axis=0)) for points in (after, before)]
    if sizes[0] > WIDER * sizes[1] > 0.0:
        wide = f"{sizes[0] / sizes[1]:.3g} times as wide as it was printed"
        yield f"the pins hold the sheet {wide}: its fabric is stretched further than on the printer"
