"""A photographed outline against the outline of a shape, seen from a side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

from asterism.draw.render import VIEWS, camera
from asterism.shape.shape import Shape
from pattern.geometry.arrays import Floats

_STEP_MM = 0.25
_STARTS = 72
# of an edge that is seen from its end
_HALF_WIDTH_MM = 0.02


@dataclass(frozen=True)
class OutlineFit:
    """An outline laid on a silhouette.

    Attributes
    ----------
    silhouette : (m, 2) mm, outer outline of the shape as it is seen.
    outline : (n, 2) mm, the photographed one, laid on it.
    distance : (k,) mm, of points along the outline from the silhouette, positive outside.
    places : (k, 2) those points.
    missed : (j,) mm, of points along the silhouette from the outline.
    turn_deg, shift : the motion of the outline.
    """

    silhouette: Floats
    outline: Floats
    distance: Floats
    places: Floats
    missed: Floats
    turn_deg: float
    shift: Floats


def silhouette(shape: Shape, view: str) -> Floats:
    """(m, 2) mm, the outer outline of a shape seen from `above`, the `front` (along y) or the `side` (along x)."""
    seen = camera(*VIEWS[view], np.zeros(3)).project(shape.positions)[:, :2]
    # triangles that are seen from their edge are lines; a little width closes the seams between all of them, too
    hulls = shapely.convex_hull(shapely.multipoints(seen[shape.triangles]))
    whole = shapely.union_all(shapely.buffer(hulls, _HALF_WIDTH_MM, quad_segs=2))
    largest = max(shapely.get_parts(whole), key=shapely.area)
    return np.asarray(largest.exterior.coords)[:-1]


def fit_outline(outline: Floats, target: Floats, trim: float = 0.1) -> OutlineFit:
    """Lay an outline (n, 2) on a silhouette (m, 2), both in mm; turned and shifted, never mirrored.

    From many turns, iterated closest points with the farthest part `trim` left out. The best of them settles where the
    sum of the distances is least, small ones by their squares.
    """
    ours, theirs = along(outline), along(target)
    tree = cKDTree(theirs)
    centre, goal = (np.array(shapely.Polygon(p).centroid.coords[0]) for p in (outline, target))
    few = ours[:: max(len(ours) // 400, 1)]
    best: tuple[float, float, Floats] = (np.inf, 0.0, np.zeros(2))
    for start in np.arange(_STARTS) * 2 * np.pi / _STARTS:
        found = _closest_points(few, start, goal - _turned(centre, start), theirs, tree, trim, 15)
        best = min(best, found, key=lambda entry: entry[0])
    angle, shift = _settled(ours[:: max(len(ours) // 1000, 1)], best[1], best[2], target)
    placed = _turned(outline, angle) + shift
    places = along(placed)
    distance = _outwards(places, target)
    missed = shapely.distance(shapely.points(theirs), shapely.LinearRing(placed))
    return OutlineFit(target, placed, distance, places, missed, float(np.rad2deg(angle)), shift)


def along(corners: Floats) -> Floats:
    """Points at equal steps along a closed line (n, 2) mm."""
    ring = shapely.LinearRing(corners)
    count = max(round(ring.length / _STEP_MM), 200)
    return np.asarray(
        shapely.get_coordinates(shapely.line_interpolate_point(ring, np.arange(count) * ring.length / count))
    )


def _settled(points: Floats, angle: float, shift: Floats, target: Floats) -> tuple[float, Floats]:
    """Turn and shift at the nearest minimum."""
    # turns count as the shifts that they make
    size = float(np.linalg.norm(points - points.mean(axis=0), axis=1).max())
    middle = _turned(points.mean(axis=0), angle) + shift

    def place(motion: Floats) -> tuple[float, Floats]:
        turn = angle + motion[0] / size
        return turn, middle + motion[1:] - _turned(points.mean(axis=0), turn)

    def distances(motion: Floats) -> Floats:
        turn, moved = place(motion)
        return _outwards(_turned(points, turn) + moved, target)

    found = least_squares(distances, np.zeros(3), loss="soft_l1", f_scale=1.0, diff_step=1e-6, x_scale=1.0)
    return place(found.x)


def _outwards(points: Floats, target: Floats) -> Floats:
    """(n,) distances from a closed line, negative within it."""
    places = shapely.points(points)
    inside = shapely.contains(shapely.Polygon(target), places)
    return np.asarray(shapely.distance(places, shapely.LinearRing(target)) * np.where(inside, -1.0, 1.0))


def _turned(points: Floats, angle: float) -> Floats:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))


def _closest_points(
    points: Floats, angle: float, shift: Floats, target: Floats, tree: cKDTree, trim: float, steps: int
) -> tuple[float, float, Floats]:
    """Cost, turn and shift after some steps; the turn is the best one in closed form (Umeyama 1991, without scale)."""
    cost = np.inf
    for _ in range(steps):
        distance, index = tree.query(_turned(points, angle) + shift)
        near = distance <= np.quantile(distance, 1 - trim)
        one, other = points[near], target[index[near]]
        x, y = one - one.mean(axis=0), other - other.mean(axis=0)
        new = float(np.arctan2(np.sum(x[:, 0] * y[:, 1] - x[:, 1] * y[:, 0]), np.sum(x * y)))
        moved = abs(new - angle)
        angle, shift = new, other.mean(axis=0) - _turned(one.mean(axis=0), new)
        cost = float(np.sqrt(np.mean(distance[near] ** 2)))
        if moved < 1e-7:
            break
    return cost, angle, shift
