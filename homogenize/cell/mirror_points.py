"""Mesh points on the mirror lines of a cell.

A mesh is symmetric about a mirror line only if no pair of mirrored points has a tie with its neighbours. So each line
gets points of its own, and free points keep a distance from it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.homogenize.cell.conforming_triangulation import MeshConstraints
from asterism.homogenize.cell.graded_steps import graded_steps
from asterism.homogenize.cell.orbits import home, nearest_image
from asterism.homogenize.cell.point_group import POINT_GROUP_TOLERANCE, MirrorLine, mirror_lines
from asterism.pattern.geometry.planar import distance_to_segment

# distance of the first point beside a star's centre from the nearest arm, over the edge length
MIN_FIRST_GAP_RATIO = 0.6
QUARTER_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
# steps along a piece of a line, for the distance to arms
_FINE = 128


@dataclass(frozen=True)
class NearbyArms:
    """All arms near a cell, as segments, with the points on them.

    Attributes
    ----------
    a, b : (n, 2) mm, centre and tip of each arm.
    points : (m, 2) mm, the mesh points on the arms; centres : (c, 2) mm, those that are centres of stars.
    """

    a: Floats
    b: Floats
    points: Floats
    centres: Floats


def with_symmetry(frame: MeshConstraints, group: Floats, arms: NearbyArms, edge_mm: float) -> MeshConstraints:
    """Constraints with the points that a mesh of this symmetry needs: on mirror lines, and at fourfold centres.

    Parameters
    ----------
    frame : points and segments that the group (G, 2, 2) maps onto themselves.
    """
    vectors, same = frame.vectors, POINT_GROUP_TOLERANCE * edge_mm
    places, sizes, walls = _mirror_points(mirror_lines(vectors, group), arms, edge_mm, same)
    if (np.abs(group - QUARTER_TURN).max(axis=(1, 2)) < POINT_GROUP_TOLERANCE).any():
        places, sizes = np.vstack([places, 0.5 * vectors.sum(axis=0)]), np.append(sizes, edge_mm)
    points, size = list(frame.points), list(frame.size)
    for place, wish in zip(home(places, vectors), sizes, strict=True):
        apart = np.linalg.norm(nearest_image(np.array(points) - place, vectors), axis=1)
        if apart.min() > same:
            points.append(place)
            size.append(wish)
        else:
            known = int(apart.argmin())
            size[known] = min(size[known], wish)
    return replace(
        frame, points=np.array(points), size=np.array(size), group=group, wall_a=walls[:, 0], wall_b=walls[:, 1]
    )


def _mirror_points(
    lines: list[MirrorLine], arms: NearbyArms, edge_mm: float, same: float
) -> tuple[Floats, Floats, Floats]:
    """Places (n, 2) mm and edge lengths (n,) mm of points on mirror lines, and the pieces (m, 2, 2) between them.

    Each line is given over one period. Pieces along arms are left out; some places are images of each other.

    Parameters
    ----------
    same : mm, distance below which two points are one.
    """
    places, sizes, walls = [np.empty((0, 2))], [np.empty(0)], [np.empty((0, 2, 2))]
    for line in lines:
        stops = _stops(line, lines, arms, same)
        for a, b in pairwise(stops):
            if _is_on_arm(line.point + 0.5 * (a + b) * line.direction, arms, same):
                continue
            along, size = _stations(line, a, b, arms, edge_mm, same)
            on_line = line.point + along[:, None] * line.direction
            places.append(on_line)
            sizes.append(size)
            walls.append(np.stack([on_line[:-1], on_line[1:]], axis=1))
    return np.concatenate(places), np.concatenate(sizes), np.concatenate(walls)


def _stops(line: MirrorLine, others: list[MirrorLine], arms: NearbyArms, same: float) -> Floats:
    """(n,) mm along one period of a line: points of arms, and crossings with other mirror lines."""
    relative = arms.points - line.point
    stops = list(relative[np.abs(relative @ line.normal) < same] @ line.direction)
    for other in others:
        slope = float(line.direction @ other.normal)
        if abs(slope) < 1e-9:
            continue
        start = float((line.point - other.point) @ other.normal)
        count = math.ceil((abs(start) + line.length) / other.offset_step) + 1
        stops += list((other.offset_step * np.arange(-count, count + 1) - start) / slope)
    whole = np.sort([stop for stop in stops if -same < stop < line.length + same])
    kept = whole[np.concatenate([[True], np.diff(whole) > same])] if len(whole) else whole
    first = kept[0] if len(kept) else 0.0  # a line without stops begins anywhere
    inner = kept[kept < first + line.length - same]
    return np.concatenate([inner if len(inner) else [first], [first + line.length]])


def _is_on_arm(place: Floats, arms: NearbyArms, same: float) -> bool:
    return bool(len(arms.a) and distance_to_segment(place, arms.a, arms.b).min() < same)


def _stations(
    line: MirrorLine, a: float, b: float, arms: NearbyArms, edge_mm: float, same: float
) -> tuple[Floats, Floats]:
    """Positions (n,) mm from a to b, both included, and edge lengths there (n,) mm."""
    ends = [line.point + stop * line.direction for stop in (a, b)]
    touches = np.zeros(len(arms.a), dtype=bool)
    first = []
    for end, sign in zip(ends, (1.0, -1.0), strict=True):
        if len(arms.a):
            touches |= distance_to_segment(end, arms.a, arms.b) < same
        first.append(_first_step(end, sign * line.direction, arms, edge_mm, same))
    low, high = a + first[0], b - first[1]
    if high - low < same:  # both ends are centres with little room: at most a point in the middle
        middle = 0.5 * (a + b)
        short = 0.5 * (b - a) < MIN_FIRST_GAP_RATIO * min(step for step in first if step)
        along = np.array([a, b] if short else [a, middle, b])
    else:
        fine = np.linspace(low, high, _FINE + 1)
        gap = np.full(len(fine), np.inf)
        if (~touches).any():
            places = line.point + fine[:, None] * line.direction
            gap = distance_to_segment(places[:, None], arms.a[~touches], arms.b[~touches]).min(axis=1)
        along = graded_steps(fine, edge_mm, gap)
        along = np.concatenate([[a] if first[0] else [], along, [b] if first[1] else []])
    step = np.diff(along)
    size = np.minimum(np.concatenate([step[:1], step]), np.concatenate([step, step[-1:]]))
    return along, np.minimum(size, edge_mm)


def _first_step(end: Floats, ahead: Floats, arms: NearbyArms, edge_mm: float, same: float) -> float:
    """mm from a star's centre to the first point on a line between two arms; 0 if the line ends elsewhere."""
    if not len(arms.a) or np.linalg.norm(arms.centres - end, axis=1).min() > same:
        return 0.0
    own = np.linalg.norm(arms.a - end, axis=1) < same
    out = (arms.b - arms.a)[own]
    cosine = float((out @ ahead / np.linalg.norm(out, axis=1)).max())
    sine = math.sqrt(max(1.0 - cosine**2, 0.0)) if cosine > 0.0 else 1.0
    return max(edge_mm, MIN_FIRST_GAP_RATIO * edge_mm / max(sine, 1e-3))
