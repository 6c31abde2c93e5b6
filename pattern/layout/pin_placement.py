"""Where the pins of a design are on its sheet.

No place is held twice, and pins that share a corner must hold it in the same way.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.pins import Pins
from asterism.pattern.geometry.planar import distance_to_outline, inside
from asterism.pattern.layout.sheet_edges import SheetEdges
from asterism.pattern.layout.supports import FIXED_BY_SLIDE, PinSet, SupportCurve, all_points, sample_supports

# length between two pins over the printed length; as large as `fabric.stretch` may be
MAX_PULL = 3.0
# Pins closer than this to a corner, the outline, an arm or another pin are there: a needle is thicker.
PIN_TOLERANCE_MM = 0.25
_NO_POINTS: Floats = np.empty((0, 2))


def pin_set(pins: Pins, corners: Floats, name: str, holes: Sequence[Floats], starts: Ints) -> PinSet:
    """The pins of one entry of `[[pins]]`.

    Raises `DesignError` if an edge, a corner or a hole does not exist, a point is off the sheet, points and targets
    differ in number, or edges with targets do not follow each other.

    Parameters
    ----------
    corners : (B, 2) mm, the outline.
    name : of the entry in messages, e.g. `pins[0]`.
    holes : (n, 2) mm each, their edges.
    starts : (k,) numbers of the corners that the design counts; the others are points of curves.
    """
    points, edges = _selected(pins, corners, name, holes, starts)
    target = curve = None
    if pins.target_mm is not None:
        target = np.asarray(pins.target_mm)
        if edges:
            numbers = tuple(range(len(starts))) if pins.edges is None else pins.edges
            curve = _curve(target, numbers, edges, corners, starts, name)
        elif len(target) != len(points):
            raise DesignError(f"{name}.target_mm", f"must have {len(points)} places, one a point", len(target))
    return PinSet(points, edges, FIXED_BY_SLIDE[pins.slide], pins.scale, pins.offset_mm, target, pins.step, curve)


def _curve(
    target: Floats, numbers: tuple[int, ...], edges: tuple[int, ...], corners: Floats, starts: Ints, name: str
) -> SupportCurve:
    """The curve through the targets (k, 3) mm of the corners along edges, which have these numbers in the design."""
    count = len(starts)
    for k, (edge, following) in enumerate(itertools.pairwise(numbers)):
        if following != (edge + 1) % count:
            allowed = f"with target_mm, must be {(edge + 1) % count}: the edges of a curve follow each other"
            raise DesignError(f"{name}.edges[{k + 1}]", allowed, following)
    is_closed = len(numbers) == count
    needed = count if is_closed else len(numbers) + 1
    if len(target) != needed:
        raise DesignError(f"{name}.target_mm", f"must have {needed} places, one for each corner", len(target))
    chain = np.array([*edges, (edges[-1] + 1) % len(corners)])
    given = np.flatnonzero(np.isin(chain, starts))
    return SupportCurve.through(corners[chain], np.concatenate([target, target[:1]]) if is_closed else target, given)


def _selected(
    pins: Pins, corners: Floats, name: str, holes: Sequence[Floats], starts: Ints
) -> tuple[Floats, tuple[int, ...]]:
    """Points (P, 2) and edges that an entry selects."""
    count = len(starts)
    if pins.where == "border" or pins.edges is not None:
        numbers = range(count) if pins.edges is None else _numbers(pins.edges, count, f"{name}.edges")
        ends = np.append(starts[1:], starts[0] + len(corners))
        pieces = [np.arange(starts[k], ends[k]) % len(corners) for k in numbers]
        return _NO_POINTS, tuple(np.concatenate(pieces).tolist())
    if pins.where == "corners":
        return corners[starts], ()
    if pins.corners is not None:
        return corners[starts[list(_numbers(pins.corners, count, f"{name}.corners"))]], ()
    if pins.holes is not None:
        sheet = SheetEdges.of(corners, holes)
        if not holes:
            raise DesignError(f"{name}.holes", "needs [[border.holes]]: the sheet has none", list(pins.holes))
        numbers = _numbers(pins.holes, len(holes), f"{name}.holes")
        return _NO_POINTS, tuple(edge for hole in numbers for edge in sheet.numbers(hole + 1).tolist())
    points = _snapped_to_outline(np.asarray(pins.points_mm), corners, f"{name}.points_mm")
    for hole in holes:
        points = _snapped(points, hole, shapely.linearrings([hole]))
    return points, ()


def _numbers(numbers: tuple[int, ...], count: int, field: str) -> tuple[int, ...]:
    """Numbers of edges, corners or holes, if all exist and differ."""
    for k, number in enumerate(numbers):
        if not 0 <= number < count:
            raise DesignError(f"{field}[{k}]", f"must be from 0 to {count - 1}", number)
        if number in numbers[:k]:
            raise DesignError(f"{field}[{k}]", "must not be listed twice", number)
    return numbers


def _snapped_to_outline(points: Floats, corners: Floats, field: str) -> Floats:
    """Points (P, 2) on the sheet; those beside a corner or an edge, as written with few digits, are moved onto it.

    The space between a pin and the outline would be too narrow for good triangles.
    """
    tolerance = max(PIN_TOLERANCE_MM, 1e-6 * float(np.ptp(corners, axis=0).max()))
    off_sheet = shapely.distance(shapely.polygons(corners), shapely.points(points)) > tolerance
    if off_sheet.any():
        k = int(off_sheet.argmax())
        raise DesignError(f"{field}[{k}]", "must be on the sheet", points[k].round(4).tolist(), place_mm=points[k])
    return _snapped(points, corners, shapely.linearrings([corners]), tolerance)


def _snapped(points: Floats, ends: Floats, lines: NDArray[np.object_], tolerance: float = PIN_TOLERANCE_MM) -> Floats:
    """Points (P, 2); those within a tolerance (mm) of an end (n, 2) of lines, or of a line, are moved onto it."""
    places = shapely.points(points)
    line = lines[shapely.STRtree(lines).nearest(places)]
    foot = shapely.get_coordinates(shapely.line_interpolate_point(line, shapely.line_locate_point(line, places)))
    beside = shapely.distance(line, places) <= tolerance
    end = ends[shapely.STRtree(shapely.points(ends)).nearest(places)]
    at_end = np.linalg.norm(points - end, axis=1) <= tolerance
    return np.where(at_end[:, None], end, np.where(beside[:, None], foot, points))


def snapped_to_lines(pins: PinSet, corners: Floats, ends: Floats, lines: NDArray[np.object_]) -> PinSet:
    """The same pins; points beside an end of a line or beside a line are moved onto it, except those on the outline.

    Parameters
    ----------
    corners : (B, 2) mm, the outline.
    ends : (n, 2) mm, ends and corners of the lines.
    lines : of shapely, mm.
    """
    if not len(pins.points):
        return pins
    from_outline = shapely.distance(shapely.linearrings(corners), shapely.points(pins.points))
    is_inside = from_outline > 1e-6 * float(np.ptp(corners, axis=0).max())
    points = np.where(is_inside[:, None], _snapped(pins.points, ends, lines), pins.points)
    return pins if np.array_equal(points, pins.points) else replace(pins, points=points)


def check_pins(sets: Sequence[PinSet], sheet: SheetEdges, starts: Ints) -> None:
    """Refuse pins in holes, places that are held twice, and pins that pull the sheet too far.

    Edges of two sets may share a corner that both hold in the same way. The error names the first of several.

    `starts`: as of `pin_set`, to name edges as the design does.
    """
    for number, pin in enumerate(sets):
        for hole in sheet.rings[1:]:
            # closer places are on the edge, but for rounding
            in_hole = inside(pin.points, hole) & (distance_to_outline(pin.points, hole) > 1e-6)
            if in_hole.any():
                _refuse(number, "must be on the sheet, not in a hole", pin.points[int(in_hole.argmax())])
    if not sets:
        return
    tolerance = 1e-6 * float(np.ptp(sheet.start, axis=0).max())
    # corners of a finely drawn outline may be closer than a pin is thick
    shortest = float(np.linalg.norm(sheet.end - sheet.start, axis=1).min())
    distance = max(tolerance, min(PIN_TOLERANCE_MM, 0.99 * shortest))
    twice = [*_points_twice(sets, sheet, distance, tolerance), *_edges_twice(sets, sheet, starts, tolerance)]
    if twice:
        _refuse(*min(twice, key=lambda conflict: conflict[0]))
    _check_reach(sets, sheet)


def _refuse(number: int, problem: str, place: Floats | str) -> None:
    """Raise the error of a pin set, at a place (2,) mm or at an edge."""
    if isinstance(place, str):
        raise DesignError(f"pins[{number}]", problem, place)
    raise DesignError(f"pins[{number}]", problem, place.round(4).tolist(), place_mm=place)


# the number of a pin set, what is wrong with it, and where
_Conflict = tuple[int, str, Floats | str]


def _points_twice(sets: Sequence[PinSet], sheet: SheetEdges, distance: float, tolerance: float) -> Iterator[_Conflict]:
    """Points closer to each other or to a held edge than `distance` (mm); to edges of later sets, than `tolerance`."""
    points, owner = all_points(sets), np.repeat(np.arange(len(sets)), [len(pins.points) for pins in sets])
    pairs = np.empty((0, 2), dtype=int)
    if len(points):
        from scipy.spatial import cKDTree  # slow to import; designs without points do without it

        # one neighbour of each point is enough, however many points share a place
        near = np.sort(cKDTree(points).query(points, k=2, distance_upper_bound=distance * (1.0 + 1e-12))[1], axis=1)
        pairs = near[near[:, 1] < len(points)]
    for first, second in pairs[np.lexsort(pairs.T)][:1].tolist():
        problem = f"must not hold the same place twice, within {distance:.2g} mm"
        if owner[first] != owner[second]:
            problem = f"must not hold what pins[{owner[first]}] holds already"
        yield int(owner[second]), problem, points[second]
    edges = np.array([edge for pins in sets for edge in pins.edges], dtype=int)
    holder = np.repeat(np.arange(len(sets)), [len(pins.edges) for pins in sets])
    lines = shapely.linestrings(np.stack([sheet.start[edges], sheet.end[edges]], axis=1))
    point, line = shapely.STRtree(lines).query(shapely.points(points), predicate="dwithin", distance=distance)
    away = shapely.distance(shapely.points(points[point]), lines[line])
    # an edge may begin beside a point of an earlier set
    conflict = (owner[point] > holder[line]) | (away <= tolerance)
    for k, edge in sorted(zip(point[conflict], line[conflict], strict=True)):
        old, new = sorted((int(owner[k]), int(holder[edge])))
        yield new, f"must not hold what pins[{old}] holds already", points[k]


def _edges_twice(sets: Sequence[PinSet], sheet: SheetEdges, starts: Ints, tolerance: float) -> Iterator[_Conflict]:
    """Edges of two sets, and corners that two sets hold in different directions or at different places."""
    holder: dict[int, int] = {}
    corner_holder: dict[int, int] = {}
    for number, new in enumerate(sets):
        for edge in sorted(new.edges):
            if (first := holder.setdefault(edge, number)) != number:
                held = _name({*new.edges} & {*sets[first].edges}, sheet, starts)
                yield number, f"must not hold what pins[{first}] holds already", held
        for corner in sorted({corner for edge in new.edges for corner in (edge, int(sheet.following[edge]))}):
            if (first := corner_holder.setdefault(corner, number)) == number:
                continue
            # along directions in which the sheet slides, the places may differ
            old, place, fixed = sets[first], sheet.start[[corner]], np.array(new.fixed)
            new_place, old_place = (pins.places(place)[:, fixed] for pins in (new, old))
            if new.fixed != old.fixed or not np.allclose(new_place, old_place, atol=tolerance):
                yield number, f"must hold the corner as pins[{first}] does", place[0]


def _name(pieces: set[int], sheet: SheetEdges, starts: Ints) -> str:
    """The whole outline, or the edge of it to which the first of some pieces belongs, or the hole, as in the design."""
    edge = min(pieces)
    if pieces.issuperset(sheet.numbers(0).tolist()):
        return "the whole outline"
    if edge < len(sheet.rings[0]):
        return f"edge {(int(np.searchsorted(starts, edge, side='right')) - 1) % len(starts)}"
    return f"hole {next(k for k in range(len(sheet.rings) - 1) if edge <= sheet.numbers(k + 1)[-1])}"


def _check_reach(sets: Sequence[PinSet], edges: SheetEdges) -> None:
    """Refuse pins so far apart that the sheet between them is longer than `MAX_PULL` times the printed length.

    The message names the second pin of the pair that is pulled most.
    """
    samples = [sample_supports([pins], edges) for pins in sets]
    # the pairs of about 200 places are compared; more places are thinned out evenly
    every = max(sum(len(each.printed) for each in samples) // 200, 1)
    printed, places, _ = (np.concatenate(parts)[::every] for parts in zip(*samples, strict=True))
    owner = np.repeat(np.arange(len(sets)), [len(each.printed) for each in samples])[::every]
    first, second = np.triu_indices(len(printed), k=1)
    # along a direction in which one of both slides, they are as close as they can be
    apart = np.linalg.norm(np.nan_to_num(places[first] - places[second]), axis=1)
    reach = np.linalg.norm(printed[first] - printed[second], axis=1)
    # a distance above 20 mm is no error of rounding between pins that are close to each other
    pull = np.where(apart > 20.0, apart / np.maximum(reach, 1e-9), 0.0)
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
