"""Sample points of all supports, printed and in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.supports import PinSet


class SupportSamples(NamedTuple):
    """Places at which supports act.

    Attributes
    ----------
    printed : (P, 2) mm.
    places : (P, 3) mm in space, not a number along directions in which the sheet slides.
    kind : (P,) equal for points of equal directions, step and shape (point or edge).
    """

    printed: Floats
    places: Floats
    kind: Ints


def sample_supports(pins: Sequence[PinSet], edges: SheetEdges) -> SupportSamples:
    """Of pins all single points, and both ends and the middle of every straight stretch of supported edges.

    Places are affine along an edge. So the samples of a stretch determine all of its places. Edges on a curve are
    sampled one by one.
    """
    printed, places, kinds = [np.empty((0, 2))], [np.empty((0, 3))], [np.empty(0, dtype=np.int64)]
    for pin in pins:
        fixed = np.asarray(pin.fixed)
        kind = 2 * int(fixed @ [1, 2, 4]) + 20 * pin.step
        stretches = pin.straight_stretches(edges) if pin.curve is None else pin.segments(edges)
        along = [np.vstack([*ends, np.mean(ends, axis=0)]) for ends in stretches]
        for points, kind_of_points in [(pin.points, kind), *((edge, kind + 1) for edge in along)]:
            if len(points):
                printed.append(points)
                places.append(np.where(fixed, pin.places(points), np.nan))
                kinds.append(np.full(len(points), kind_of_points))
    all_printed, all_kinds = np.concatenate(printed), np.concatenate(kinds)
    if len(all_printed) == 0:
        return SupportSamples(all_printed, places[0], all_kinds)
    # neighbouring edges share a corner
    _, first = np.unique(np.round(np.column_stack([all_printed, all_kinds]), 6), axis=0, return_index=True)
    return SupportSamples(all_printed[first], np.concatenate(places)[first], all_kinds[first])
