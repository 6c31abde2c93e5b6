"""No place of the sheet is held twice, and corners that pins share are held in the same way by all of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from pattern.design.errors import DesignError
from pattern.design.pins import ON_MM, pair
from pattern.geometry.arrays import Floats
from pattern.layout.layout import PinSet


def check_agreement(sets: Sequence[PinSet], corners: Floats) -> None:
    """Refuse a place held twice; edges of two sets may share a corner that both hold in the same way.

    Of several mistakes it tells that of the first set.
    """
    near = 1e-6 * float(np.ptp(corners, axis=0).max())
    # corners of a finely drawn outline may be closer
    shortest = float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min())
    apart = max(near, min(ON_MM, 0.99 * shortest))
    found = [*_points_twice(sets, apart), *_edges_twice(sets), *_points_on_edges(sets, corners, apart, near)]
    found += _corners_apart(sets, corners, near)
    if found:
        raise min(found, key=lambda one: one[0])[1]


def _again(new: int, old: int, value: object) -> tuple[int, DesignError]:
    return new, DesignError(f"pins[{new}]", f"must not hold what pins[{old}] holds already", value)


def _points_twice(sets: Sequence[PinSet], apart: float) -> Iterator[tuple[int, DesignError]]:
    points, owner = _points(sets)
    if len(points) < 2:
        return
    from scipy.spatial import cKDTree  # takes a moment, which most designs need not wait for

    # of many in one place each finds one other
    far, near = cKDTree(points).query(points, k=2, distance_upper_bound=apart * (1.0 + 1e-12))
    number = np.arange(len(points))
    other = np.where((near[:, 0] == number) | np.isinf(far[:, 0]), near[:, 1], near[:, 0])
    twice = other < len(points)
    pairs = np.sort(np.column_stack([number, other])[twice], axis=1)
    for one, other in pairs[np.lexsort(pairs.T)][:1].tolist():
        if owner[one] == owner[other]:
            allowed = f"must not hold the same place twice, within {apart:.2g} mm"
            yield int(owner[other]), DesignError(f"pins[{owner[other]}]", allowed, pair(points[other]))
        else:
            yield _again(int(owner[other]), int(owner[one]), pair(points[other]))


def _edges_twice(sets: Sequence[PinSet]) -> Iterator[tuple[int, DesignError]]:
    holder: dict[int, int] = {}
    for number, pins in enumerate(sets):
        for edge in sorted(pins.edges):
            if edge in holder:
                yield _again(number, holder[edge], f"edge {edge}")
            holder.setdefault(edge, number)


def _points_on_edges(
    sets: Sequence[PinSet], corners: Floats, apart: float, near: float
) -> Iterator[tuple[int, DesignError]]:
    points, owner = _points(sets)
    edges = np.array([edge for pins in sets for edge in pins.edges], dtype=int)
    holder = np.array([number for number, pins in enumerate(sets) for _ in pins.edges], dtype=int)
    if not (len(points) and len(edges)):
        return
    lines = shapely.linestrings(np.stack([corners[edges], np.roll(corners, -1, axis=0)[edges]], axis=1))
    which, on = shapely.STRtree(lines).query(shapely.points(points), predicate="dwithin", distance=apart)
    away = shapely.distance(shapely.points(points[which]), lines[on])
    # an edge may begin beside a point that is held before
    meant = (owner[which] > holder[on]) | (away <= near)
    for point, line in sorted(zip(which[meant], on[meant], strict=True)):
        one, other = sorted((int(owner[point]), int(holder[line])))
        yield _again(other, one, pair(points[point]))


def _corners_apart(sets: Sequence[PinSet], corners: Floats, near: float) -> Iterator[tuple[int, DesignError]]:
    holder: dict[int, int] = {}
    for number, new in enumerate(sets):
        for corner in sorted({corner % len(corners) for edge in new.edges for corner in (edge, edge + 1)}):
            first = holder.setdefault(corner, number)
            if first == number:
                continue
            old, place, firm = sets[first], corners[[corner]], np.array(new.fixed)  # what slides may differ
            here, there = (pins.places(place)[:, firm] for pins in (new, old))
            if new.fixed != old.fixed or not np.allclose(here, there, atol=near):
                allowed = f"must hold the corner as pins[{first}] does"
                yield number, DesignError(f"pins[{number}]", allowed, pair(corners[corner]))


def _points(sets: Sequence[PinSet]) -> tuple[Floats, np.ndarray]:
    """(P, 2) all points, and (P,) the set of each."""
    points = np.concatenate([np.empty((0, 2)), *(pins.points for pins in sets)])
    return points, np.repeat(np.arange(len(sets)), [len(pins.points) for pins in sets])
