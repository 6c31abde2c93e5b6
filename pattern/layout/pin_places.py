"""Every place at which pins hold a sheet, printed and in space."""

from __future__ import annotations

import numpy as np

from pattern.geometry.arrays import Floats, Ints
from pattern.geometry.planar import STRAIGHT, turns
from pattern.layout.layout import Layout


def pin_places(layout: Layout) -> tuple[Floats, Floats, Ints]:
    """Printed places (P, 2), places in space (P, 3), nan where free, and the kind of every pin point.

    An edge is held like its ends and middle; places are linear along it. Edges that go straight on are one.
    """
    printed, places, kinds = [np.empty((0, 2))], [np.empty((0, 3))], [np.empty(0, dtype=np.int64)]
    border = layout.border
    for pin in layout.pins:
        fixed = np.asarray(pin.fixed)
        kind = 2 * int(fixed @ [1, 2, 4]) + 20 * pin.step
        edges = [np.vstack([ends, ends.mean(axis=0)]) for ends in _stretches(border, pin.edges)]
        for points, one in [(pin.points, kind), *((edge, kind + 1) for edge in edges)]:
            if len(points):
                printed.append(points)
                places.append(np.where(fixed, pin.places(points), np.nan))
                kinds.append(np.full(len(points), one))
    printed_all, kind_all = np.concatenate(printed), np.concatenate(kinds)
    if len(printed_all) == 0:
        return printed_all, places[0], kind_all
    # neighbouring edges share a corner
    _, first = np.unique(np.round(np.column_stack([printed_all, kind_all]), 6), axis=0, return_index=True)
    return printed_all[first], np.concatenate(places)[first], kind_all[first]


def _stretches(border: Floats, edges: tuple[int, ...]) -> list[Floats]:
    """(2, 2) ends of every straight stretch that held edges make together."""
    held, count = set(edges), len(border)
    goes_on = np.abs(turns(border)) <= STRAIGHT  # at corner i, from edge i - 1 to edge i
    found = []
    for edge in edges:
        if goes_on[edge] and (edge - 1) % count in held:
            continue
        last = edge
        while goes_on[(last + 1) % count] and (last + 1) % count in held:
            last = (last + 1) % count
        found.append(np.array([border[edge], border[(last + 1) % count]]))
    return found
