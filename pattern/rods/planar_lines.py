"""Lines of a drawing cut where they meet: ends moved onto lines beside them, crossings found, nodes merged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import clusters, nearest_segment, turning_angles
from asterism.pattern.rods.graph import CORNER_DEG

# mm: places closer than this are one, but for rounding
SAME_PLACE_MM = 1e-6
# more have no room on a sheet, and take minutes
MAX_MEETINGS = 100_000
_SHAPES_AT_ONCE = 100


@dataclass(frozen=True)
class Piece:
    """A part of a line between two nodes."""

    line: int  # number of the line
    points: Floats  # (n, 2) mm, from node to node
    # start, end: numbers of the nodes.
    start: int
    end: int


def cut_lines(lines: list[Floats], join_mm: float, merge_mm: float, names: list[str]) -> tuple[Floats, list[Piece]]:
    """Nodes (N, 2) mm of lines, and the pieces between them, line by line along the line.

    Parameters
    ----------
    lines : polylines (n, 2) mm; a closed one ends with its first point.
    join_mm : an open end nearer than this to an end or corner is moved there, else onto a line that is as near.
    merge_mm : nodes nearer than this to each other become one, and loose ends shorter than this are dropped.
    names : of the lines, for messages.

    Raises
    ------
    DesignError
        Two lines lie on each other.

    Examples
    --------
    Two lines that cross, one of which ends just beside a third:

    >>> cross = [np.array([[-5.0, 0.0], [5.0, 0.0]]), np.array([[0.0, -5.0], [0.0, 4.95]])]
    >>> nodes, pieces = cut_lines([*cross, np.array([[-5.0, 5.0], [5.0, 5.0]])], 0.1, 0.6, ["", "", ""])
    >>> len(nodes), [(piece.line, piece.start, piece.end) for piece in pieces]
    (7, [(0, 0, 6), (0, 6, 1), (1, 2, 6), (1, 6, 3), (2, 4, 3), (2, 3, 5)])
    """
    lines = _joined(lines, join_mm)
    places, owners, parts = _meetings(lines, names)
    meetings = len(places)
    for number, line in enumerate(lines):
        at = _key_points(line)
        places.extend(line[at])
        owners.extend([number] * len(at))
        parts.extend(at.astype(float))
    place, owner, part = np.array(places).reshape(-1, 2), np.array(owners, dtype=np.int64), np.array(parts)
    # ends and corners first: merged nodes are there
    order = np.concatenate([np.arange(meetings, len(place)), np.arange(meetings)])
    place, owner, part = place[order], owner[order], part[order]
    node, nodes = clusters(place, merge_mm)
    pieces = []
    of_lines = np.split(np.argsort(owner, kind="stable"), np.cumsum(np.bincount(owner, minlength=len(lines)))[:-1])
    for number, (line, of_line) in enumerate(zip(lines, of_lines, strict=True)):
        pieces += _split(number, line, part[of_line], node[of_line], nodes, merge_mm)
    degree = np.bincount([end for piece in pieces for end in (piece.start, piece.end)], minlength=len(nodes))
    kept = [
        piece for piece in pieces if min(degree[piece.start], degree[piece.end]) > 1 or _length(piece.points) > merge_mm
    ]
    if not kept:
        problem = f"all lines are shorter than {max(join_mm, merge_mm):g} mm: is the drawing in mm?"
        raise DesignError("rods", problem)
    used, index = np.unique([[piece.start, piece.end] for piece in kept], return_inverse=True)
    ends = index.reshape(-1, 2)
    return nodes[used], [Piece(p.line, p.points, int(a), int(b)) for p, (a, b) in zip(kept, ends, strict=True)]


def is_closed(line: Floats) -> bool:
    """Whether a polyline returns to its first point."""
    return len(line) > 3 and bool(np.linalg.norm(line[0] - line[-1]) <= SAME_PLACE_MM)


def _key_points(line: Floats) -> Ints:
    """Numbers of the points of a line that are nodes by themselves: both ends, and corners."""
    if len(line) == 2:
        return np.array([0, 1])
    # a ring without a corner has its seam at its first point; both of its ends are this node
    turns = turning_angles(line[:-1] if is_closed(line) else line)
    return np.unique(np.concatenate([[0], np.flatnonzero(np.abs(turns) > np.radians(CORNER_DEG)), [len(line) - 1]]))


def _joined(lines: list[Floats], join_mm: float) -> list[Floats]:
    """The lines with their open ends moved: to an end or corner nearby, else onto a line nearby."""
    lines = [line.copy() for line in lines]
    ends = [(number, at) for number, line in enumerate(lines) if not is_closed(line) for at in (0, -1)]
    key = [(number, at) for number, line in enumerate(lines) for at in _key_points(line)]
    places = np.array([lines[number][at] for number, at in key]).reshape(-1, 2)
    node, merged = clusters(places, join_mm)
    size = np.bincount(node, minlength=len(merged))
    fixed = {int(node[i]): places[i] for i, (number, at) in enumerate(key) if not _is_end(lines[number], int(at))}
    target = {k: fixed.get(k, merged[k]) for k in range(len(merged))}
    cluster_of = {(number, int(at)): int(node[i]) for i, (number, at) in enumerate(key)}
    loose = []
    for number, at in ends:
        cluster = cluster_of[number, at % len(lines[number])]
        if size[cluster] > 1:
            lines[number][at] = target[cluster]
        else:
            loose.append((number, at))
    shapes = [shapely.LineString(line) for line in lines]
    tree = shapely.STRtree(shapes)
    feet: list[tuple[int, int, int, Floats]] = []
    for number, at in loose:
        point = shapely.Point(lines[number][at])
        nearby = [int(k) for k in tree.query(point, predicate="dwithin", distance=join_mm) if k != number]
        if nearby:
            nearest = min(nearby, key=lambda k: (shapes[k].distance(point), k))
            foot = shapes[nearest].interpolate(shapes[nearest].project(point))
            feet.append((number, at, nearest, np.array(foot.coords[0])))
    for number, at, nearest, foot_place in feet:
        lines[number][at] = foot_place
        lines[nearest] = _with_point(lines[nearest], foot_place)
    return lines


def _is_end(line: Floats, at: int) -> bool:
    return not is_closed(line) and at in (0, len(line) - 1)


def _with_point(line: Floats, place: Floats) -> Floats:
    """The line with a point on it as one of its points."""
    if np.linalg.norm(line - place, axis=1).min() <= SAME_PLACE_MM:
        return line
    piece = int(nearest_segment(place[None], line[:-1], line[1:])[0])
    return np.insert(line, piece + 1, place, axis=0)


def _meetings(lines: list[Floats], names: list[str]) -> tuple[list[Floats], list[int], list[float]]:
    """Places where segments of lines meet, with the line and its fractional point number of each side."""
    segments = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    owner = np.repeat(np.arange(len(lines)), [len(line) - 1 for line in lines])
    number = np.concatenate([np.arange(len(line) - 1) for line in lines])
    shapes = shapely.linestrings(segments)
    first, second = _near_pairs(shapes)
    last = np.array([len(line) - 2 for line in lines])
    ring = np.array([is_closed(line) for line in lines])
    same, gap = owner[first] == owner[second], np.abs(number[first] - number[second])
    beside = same & ((gap <= 1) | (ring[owner[first]] & (gap == last[owner[first]])))
    places: list[Floats] = []
    owners: list[int] = []
    parts: list[float] = []
    for i, j in zip(first[~beside], second[~beside], strict=True):
        place = _meeting(segments[i], segments[j])
        if place is None:
            x, y = segments[i].mean(axis=0)
            one, other = sorted(names[owner[k]] or "a line" for k in (i, j))
            both = f"two lines named {one}" if one == other else f"{one} and {other}"
            raise DesignError("rods", f"{both} lie on each other at [{x:.2f}, {y:.2f}]: draw the line once")
        for k in (i, j):
            step = segments[k][1] - segments[k][0]
            part = min(max(float((place - segments[k][0]) @ step / (step @ step)), 0.0), 1.0)
            places.append(place)
            owners.append(int(owner[k]))
            parts.append(float(number[k]) + part)
    return places, owners, parts


def _near_pairs(shapes: np.ndarray) -> tuple[Ints, Ints]:
    """Numbers of two shapes that touch within rounding, the smaller one first."""
    tree, pairs, count = shapely.STRtree(shapes), [np.empty((2, 0), dtype=np.int64)], 0
    for start in range(0, len(shapes), _SHAPES_AT_ONCE):
        found = tree.query(shapes[start : start + _SHAPES_AT_ONCE], predicate="dwithin", distance=SAME_PLACE_MM)
        found[0] += start
        pairs.append(found[:, found[0] < found[1]])
        count += pairs[-1].shape[1]
        if count > MAX_MEETINGS + 2 * len(shapes):
            raise DesignError("rods", f"lines must meet at most {MAX_MEETINGS} times: draw fewer, or shorter ones")
    first, second = np.concatenate(pairs, axis=1)
    return first, second


def _meeting(first: Floats, second: Floats) -> Floats | None:
    """(2,) mm, where two segments (2, 2) that touch within rounding meet; None if they lie on each other."""
    (a, b), (c, d) = first, second
    u, v, w = b - a, d - c, c - a
    cross = u[0] * v[1] - u[1] * v[0]
    if abs(cross) <= 1e-9 * np.linalg.norm(u) * np.linalg.norm(v):
        along = np.sort(np.array([w @ u, (d - a) @ u]) / (u @ u))
        shared = (min(along[1], 1.0) - max(along[0], 0.0)) * float(np.linalg.norm(u))
        if shared > SAME_PLACE_MM:
            return None
        return np.asarray(a + np.clip(0.5 * (max(along[0], 0.0) + min(along[1], 1.0)), 0.0, 1.0) * u)
    return np.asarray(a + min(max(float((w[0] * v[1] - w[1] * v[0]) / cross), 0.0), 1.0) * u)


def _split(number: int, line: Floats, part: Floats, node: Ints, nodes: Floats, merge_mm: float) -> list[Piece]:
    """The pieces of a line between nodes at fractional point numbers `part`."""
    order = np.argsort(part, kind="stable")
    part, node = part[order], node[order]
    pieces = []
    for k in range(len(part) - 1):
        inner = line[int(np.floor(part[k])) + 1 : int(np.ceil(part[k + 1]))]
        ends = nodes[node[[k, k + 1]]]
        if len(inner):
            is_clear = np.linalg.norm(inner[:, None] - ends, axis=2) > merge_mm
            inner = inner[is_clear.all(axis=1)]
        points = np.concatenate([ends[:1], inner, ends[1:]])
        if node[k] == node[k + 1] and _length(points) <= 4.0 * merge_mm:
            continue  # the same node twice
        pieces.append(Piece(number, points, int(node[k]), int(node[k + 1])))
    return pieces


def _length(points: Floats) -> float:
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
