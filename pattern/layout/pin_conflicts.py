"""Conflicts between pins: no place is held twice, and pins that share a corner must hold it in the same way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import DesignError
from asterism.pattern.layout.pin_placement import PIN_TOLERANCE_MM, rounded_place
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.supports import PinSet, all_points, set_of_point

# length between two pins over the printed length; as large as `fabric.stretch` may be
MAX_PULL = 3.0
# a longer distance is no error of rounding between pins that are close to each other
MIN_PULLED_MM = 20.0
# pins whose pairs are compared; more pins are thinned out evenly
MAX_COMPARED_PINS = 200


class _Conflict(NamedTuple):
    """An error, and the number of the pin set that it is reported for."""

    number: int
    error: DesignError


def check_conflicts(sets: Sequence[PinSet], sheet: SheetEdges) -> None:
    """Refuse a place that is held twice. Edges of two sets may share a corner that both hold in the same way.

    Parameters
    ----------
    sheet : the edges of the sheet.

    Raises
    ------
    DesignError
        Of several conflicts, that of the first set.
    """
    sets = tuple(sets)
    tolerance = 1e-6 * float(np.ptp(sheet.start, axis=0).max())
    # corners of a finely drawn outline may be closer than a pin is thick
    shortest = float(np.linalg.norm(sheet.end - sheet.start, axis=1).min())
    distance = max(tolerance, min(PIN_TOLERANCE_MM, 0.99 * shortest))
    conflicts = [*_points_twice(sets, distance), *_edges_twice(sets)]
    conflicts += _points_on_edges(sets, sheet, distance, tolerance)
    conflicts += _corners_differ(sets, sheet, tolerance)
    if conflicts:
        raise min(conflicts, key=lambda conflict: conflict.number).error


def _repeated(new: int, old: int, value: object, place_mm: Floats | None = None) -> _Conflict:
    allowed = f"must not hold what pins[{old}] holds already"
    return _Conflict(new, DesignError(f"pins[{new}]", allowed, value, place_mm=place_mm))


def _points_twice(sets: tuple[PinSet, ...], distance: float) -> Iterator[_Conflict]:
    """Points closer to each other than `distance` (mm)."""
    points, owner = all_points(sets), set_of_point(sets)
    if len(points) < 2:
        return
    from scipy.spatial import cKDTree  # slow to import; designs without pins do without it

    # one partner for each point is enough, however many points share a place
    away, near = cKDTree(points).query(points, k=2, distance_upper_bound=distance * (1.0 + 1e-12))
    number = np.arange(len(points))
    partner = np.where((near[:, 0] == number) | np.isinf(away[:, 0]), near[:, 1], near[:, 0])
    close = partner < len(points)
    pairs = np.sort(np.column_stack([number, partner])[close], axis=1)
    for first, second in pairs[np.lexsort(pairs.T)][:1].tolist():
        if owner[first] == owner[second]:
            allowed = f"must not hold the same place twice, within {distance:.2g} mm"
            place = points[second]
            error = DesignError(f"pins[{owner[second]}]", allowed, rounded_place(place), place_mm=place)
            yield _Conflict(int(owner[second]), error)
        else:
            place = points[second]
            yield _repeated(int(owner[second]), int(owner[first]), rounded_place(place), place)


def _edges_twice(sets: tuple[PinSet, ...]) -> Iterator[_Conflict]:
    holder: dict[int, int] = {}
    for number, pins in enumerate(sets):
        for edge in sorted(pins.edges):
            if edge in holder:
                yield _repeated(number, holder[edge], f"edge {edge}")
            holder.setdefault(edge, number)


def _points_on_edges(
    sets: tuple[PinSet, ...], sheet: SheetEdges, distance: float, tolerance: float
) -> Iterator[_Conflict]:
    """Points closer to a held edge than `distance` (mm), or on it within `tolerance` (mm) for earlier points."""
    points, owner = all_points(sets), set_of_point(sets)
    edges = np.array([edge for pins in sets for edge in pins.edges], dtype=int)
    holder = np.array([number for number, pins in enumerate(sets) for _ in pins.edges], dtype=int)
    if not (len(points) and len(edges)):
        return
    lines = shapely.linestrings(np.stack([sheet.start[edges], sheet.end[edges]], axis=1))
    point, line = shapely.STRtree(lines).query(shapely.points(points), predicate="dwithin", distance=distance)
    away = shapely.distance(shapely.points(points[point]), lines[line])
    # an edge may begin beside a point of an earlier set
    conflict = (owner[point] > holder[line]) | (away <= tolerance)
    for k, edge in sorted(zip(point[conflict], line[conflict], strict=True)):
        old, new = sorted((int(owner[k]), int(holder[edge])))
        yield _repeated(new, old, rounded_place(points[k]), points[k])


def _corners_differ(sets: tuple[PinSet, ...], sheet: SheetEdges, tolerance: float) -> Iterator[_Conflict]:
    """Corners between held edges of two sets that hold them in different directions or at different places."""
    holder: dict[int, int] = {}
    for number, new in enumerate(sets):
        for corner in sorted({corner for edge in new.edges for corner in (edge, int(sheet.following[edge]))}):
            first = holder.setdefault(corner, number)
            if first == number:
                continue
            # along directions in which the sheet slides, the places may differ
            old, place, fixed = sets[first], sheet.start[[corner]], np.array(new.fixed)
            new_place, old_place = (pins.places(place)[:, fixed] for pins in (new, old))
            if new.fixed != old.fixed or not np.allclose(new_place, old_place, atol=tolerance):
                allowed = f"must hold the corner as pins[{first}] does"
                shown = rounded_place(sheet.start[corner])
                error = DesignError(f"pins[{number}]", allowed, shown, place_mm=sheet.start[corner])
                yield _Conflict(number, error)


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
