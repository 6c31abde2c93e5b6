"""How far a supported sheet rises over its needles, and hangs below them."""

from __future__ import annotations

from typing import NamedTuple

from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.off_sheet import off_sheet_mm
from asterism.shape.shape import Shape


class NeedleClearance(NamedTuple):
    """Heights of a sheet with respect to its supports.

    Attributes
    ----------
    above_mm : height of the highest point of the sheet over its highest support.
    below_mm : depth of the lowest point of the sheet below its lowest support.
    """

    above_mm: float
    below_mm: float


def needle_clearance(layout: Layout, shape: Shape) -> NeedleClearance | None:
    """The clearance of a supported sheet; None for a free sheet.

    Examples
    --------
    >>> import numpy as np
    >>> from asterism.pattern.layout.print_layout import print_layout
    >>> from asterism.pattern.gallery import load
    >>> plan = print_layout(load("dome"))
    >>> corners = np.vstack([plan.outline, [[0.0, 0.0]]])
    >>> rim = np.arange(len(plan.outline))
    >>> fan = np.column_stack([rim, np.roll(rim, -1), np.full(len(rim), len(rim))])
    >>> height = np.append(np.zeros(len(rim)), 12.0)
    >>> positions, no_star = np.column_stack([corners, height]), np.full(len(height), -1)
    >>> tent = Shape(corners, positions, fan, no_star, (), np.array([len(rim)]))
    >>> [round(height, 6) for height in needle_clearance(plan, tent)]
    [12.0, 0.0]
    """
    printed = layout.support_samples.printed
    if len(printed) == 0:
        return None
    supported, heights = shape.at(printed, off_sheet_mm(layout, len(shape.printed)))[:, 2], shape.positions[:, 2]
    above, below = heights.max() - supported.max(), supported.min() - heights.min()
    return NeedleClearance(max(float(above), 0.0), max(float(below), 0.0))
