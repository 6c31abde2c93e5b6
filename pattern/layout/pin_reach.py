"""Pins that would pull the sheet further than any fabric stretches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.supports import PinSet

# length between two pins over the printed length; as large as `fabric.stretch` may be
MAX_PULL = 3.0
# a longer distance is no error of rounding between pins that are close to each other
MIN_PULLED_MM = 20.0
# pins whose pairs are compared; more pins are thinned out evenly
MAX_COMPARED_PINS = 200


def check_reach(sets: Sequence[PinSet], edges: SheetEdges) -> None:
    """Refuse pins so far apart that the sheet between them is longer than `MAX_PULL` times the printed length.

    Parameters
    ----------
    edges : of the sheet.

    Raises
    ------
    DesignError
        The message names the second pin of the pair that is pulled most.
    """
    printed, places, owner = _samples(sets, edges)
    if len(printed) < 2:
        return
    first, second = np.triu_indices(len(printed), k=1)
    # along a direction in which one of both slides, they are as close as they can be
    apart = np.linalg.norm(np.nan_to_num(places[first] - places[second]), axis=1)
    reach = np.linalg.norm(printed[first] - printed[second], axis=1)
    pull = np.where(apart > MIN_PULLED_MM, apart / np.maximum(reach, 1e-9), 0.0)
    sheet = shapely.Polygon(edges.rings[0], edges.rings[1:])
    half_way_round = 0.5 * float(shapely.length(sheet.exterior))
    for pair in np.argsort(-pull)[: np.count_nonzero(pull > MAX_PULL)]:
        i, j = int(first[pair]), int(second[pair])
        # the way through the sheet is the straight line, unless the outline or a hole is in between
        line = shapely.linestrings([printed[i], printed[j]])
        if not shapely.covers(sheet.buffer(1e-6 * half_way_round), line) and apart[pair] <= MAX_PULL * half_way_round:
            continue
        (x, y), (u, v) = printed[i], printed[j]
        raise DesignError(
            f"pins[{owner[j]}]",
            f"pulls the sheet to {pull[pair]:.3g} times its printed length between [{x:.1f}, {y:.1f}] and "
            f"[{u:.1f}, {v:.1f}]: at most {MAX_PULL:g} times is allowed",
            place_mm=printed[j],
        )


def _samples(sets: Sequence[PinSet], edges: SheetEdges) -> tuple[Floats, Floats, Ints]:
    """Printed points (n, 2), their places (n, 3), not a number where the sheet slides, and the sets they belong to."""
    printed, places, owner = [np.empty((0, 2))], [np.empty((0, 3))], [np.empty(0, dtype=np.int64)]
    for number, pins in enumerate(sets):
        ends = np.array([end for segment in pins.segments(edges) for end in segment]).reshape(-1, 2)
        for points in (pins.points, ends):
            if len(points):
                printed.append(points)
                places.append(np.where(pins.fixed, pins.places(points), np.nan))
                owner.append(np.full(len(points), number))
    every = max(sum(map(len, printed)) // MAX_COMPARED_PINS, 1)
    return np.concatenate(printed)[::every], np.concatenate(places)[::every], np.concatenate(owner)[::every]
