"""Plane geometry of polygons, segments and triangles, for many of them at once."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from jaxtyping import Bool, Float, Int

from asterism.equilibrium.arrays import Floats, Ints

# entries of a table of distances
MAX_TABLE_ENTRIES = 2_000_000
# an outline that turns by less has no corner there
STRAIGHT_TURN_RAD = 1e-6


def shown_place(place: Floats | Sequence[float]) -> str:
    """A place (2,) mm as messages show it."""
    return f"[{place[0]:.2f}, {place[1]:.2f}]"


def cross_2d(a: Floats, b: Floats) -> Floats:
    """z component of the cross product of the vectors in the last axis."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def polygon_area(polygon: Float[np.ndarray, "n 2"]) -> float:
    """Signed area of a polygon (n, 2): positive if counterclockwise."""
    return float(cross_2d(polygon, np.roll(polygon, -1, axis=0)).sum() / 2)


def dense_outline(ring: Float[np.ndarray, "n 2"], step_mm: float = 2.0) -> Float[np.ndarray, "m 2"]:
    """(m, 2) points along a ring (n, 2), its corners among them, at most `step_mm` apart.

    >>> dense_outline(np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 1.0]])).shape
    (5, 2)
    """
    closed = shapely.segmentize(shapely.linearrings(ring), step_mm)
    return np.asarray(shapely.get_coordinates(closed)[:-1])


def turning_angles(ring: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, " n"]:
    """(n,) rad, angle by which a ring (n, 2) turns left at each point.

    >>> turning_angles(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])).round(4).tolist()
    [1.5708, 1.5708, 1.5708, 1.5708]
    """
    ahead, behind = np.roll(ring, -1, axis=0) - ring, ring - np.roll(ring, 1, axis=0)
    return np.asarray(np.arctan2(cross_2d(behind, ahead), (behind * ahead).sum(axis=1)))


def triangle_areas(points: Float[np.ndarray, "V 2"], triangles: Int[np.ndarray, "T 3"]) -> Float[np.ndarray, " T"]:
    """Signed areas (T,) of triangles: positive if counterclockwise."""
    x, y = points.T
    a, b, c = triangles.T
    return np.asarray((x[b] - x[a]) * (y[c] - y[a]) - (y[b] - y[a]) * (x[c] - x[a])) / 2


def triangle_gradients(
    points: Float[np.ndarray, "V 2"], triangles: Int[np.ndarray, "T 3"]
) -> Float[np.ndarray, "T 3 2"]:
    """Gradients (T, 3, 2) of the barycentric coordinates of triangles, 1 over the unit of the points."""
    a, b, c = points[triangles].swapaxes(0, 1)
    e1, e2 = b - a, c - a
    twice = cross_2d(e1, e2)[:, None]
    b1 = np.column_stack([e2[:, 1], -e2[:, 0]]) / twice
    b2 = np.column_stack([-e1[:, 1], e1[:, 0]]) / twice
    return np.stack([-b1 - b2, b1, b2], axis=1)


def triangle_angles(points: Float[np.ndarray, "V 2"], triangles: Int[np.ndarray, "T 3"]) -> Float[np.ndarray, "T 3"]:
    """Angles (T, 3) in degrees at the corners of triangles."""
    x, y = points[:, 0][triangles.T], points[:, 1][triangles.T]
    (ux, vx), (uy, vy) = ((np.roll(one, -1, axis=0) - one, np.roll(one, 1, axis=0) - one) for one in (x, y))
    return np.degrees(np.arctan2(np.abs(ux * vy - uy * vx), ux * vx + uy * vy)).T


def mean_circumcentres(points: Float[np.ndarray, "V 2"], triangles: Int[np.ndarray, "T 3"]) -> Float[np.ndarray, "V 2"]:
    """Mean (n, 2), weighted by area, of the circumcentres of the triangles at each point.

    Moving points there lowers the interpolation error of a paraboloid (optimal Delaunay triangulations, Chen and Xu
    2004), which makes triangles equilateral.
    """
    a, b, c = points[triangles].swapaxes(0, 1)
    u, v = b - a, c - a
    twice = cross_2d(u, v)
    u2, v2 = (u**2).sum(axis=1), (v**2).sum(axis=1)
    from_a = np.column_stack([u2 * v[:, 1] - v2 * u[:, 1], v2 * u[:, 0] - u2 * v[:, 0]]) / (2 * twice[:, None])
    corner, weight = triangles.ravel(), np.repeat(twice, 3)
    weighted = [np.bincount(corner, weight * np.repeat(x, 3), len(points)) for x in (a + from_a).T]
    return np.column_stack(weighted) / np.bincount(corner, weight, len(points))[:, None]


def is_in_sorted(numbers: Int[np.ndarray, " n"], ordered: Int[np.ndarray, " m"]) -> Bool[np.ndarray, " n"]:
    """(n,) whether each number is among sorted ones (m,); several times as fast as `np.isin`."""
    if len(ordered) == 0:
        return np.zeros(len(numbers), dtype=bool)
    return np.asarray(ordered[np.minimum(np.searchsorted(ordered, numbers), len(ordered) - 1)] == numbers)


def inside(
    points: Float[np.ndarray, "n 2"], polygon: Float[np.ndarray, "c 2"], holes: Sequence[Floats] = ()
) -> Bool[np.ndarray, " n"]:
    """Which points (n, 2) lie in a simple polygon and in no hole; either answer for points on an edge."""
    region = shapely.Polygon(polygon, holes)
    shapely.prepare(region)
    return np.asarray(shapely.contains_xy(region, points), dtype=bool)


def distance_to_segment(
    points: Float[np.ndarray, "*#n 2"], a: Float[np.ndarray, "*#n 2"], b: Float[np.ndarray, "*#n 2"]
) -> Float[np.ndarray, " *n"]:
    """Distance of points to segments a-b; the three arrays (..., 2) broadcast."""
    ax, ay = a[..., 0], a[..., 1]
    along_x, along_y = b[..., 0] - ax, b[..., 1] - ay
    x, y = points[..., 0] - ax, points[..., 1] - ay
    t = (x * along_x + y * along_y) / np.maximum(along_x**2 + along_y**2, np.finfo(float).tiny)
    t = np.minimum(np.maximum(t, 0.0), 1.0)
    return np.asarray(np.sqrt((x - t * along_x) ** 2 + (y - t * along_y) ** 2))


def nearest_segment(
    points: Float[np.ndarray, "n 2"], a: Float[np.ndarray, "s 2"], b: Float[np.ndarray, "s 2"]
) -> Int[np.ndarray, " n"]:
    """(n,) number of the segment from `a` to `b` (s, 2) that each point (n, 2) is nearest to, the first of equals."""
    chunks = np.array_split(points, len(points) * len(a) // MAX_TABLE_ENTRIES + 1)
    return np.concatenate([distance_to_segment(some[:, None], a, b).argmin(axis=1) for some in chunks])


def distance_to_outline(points: Float[np.ndarray, "n 2"], polygon: Float[np.ndarray, "c 2"]) -> Float[np.ndarray, " n"]:
    """Distance (n,) of points to the outline of a polygon."""
    ring = shapely.linearrings(polygon)
    shapely.prepare(ring)
    return np.asarray(shapely.distance(ring, shapely.points(points)), dtype=float)


def distance_along(
    points: Float[np.ndarray, "n 2"], direction: Float[np.ndarray, " 2"], polygon: Float[np.ndarray, "c 2"]
) -> Float[np.ndarray, " n"]:
    """Distance (n,) from points to a polygon's outline along a unit vector (2,); infinite where the ray misses it."""
    start, edge = polygon, np.roll(polygon, -1, axis=0) - polygon
    to, turn = start - points[:, None], cross_2d(direction, edge)
    crosses = np.abs(turn) > 1e-12 * np.linalg.norm(edge, axis=1)  # others run along
    safe = np.where(crosses, turn, 1.0)
    along, part = cross_2d(to, edge) / safe, cross_2d(to, direction) / safe
    meets = crosses & (along >= 0.0) & (part >= 0.0) & (part <= 1.0)
    return np.asarray(np.where(meets, along, np.inf).min(axis=1))


def clusters(places: Floats, distance: float) -> tuple[Ints, Floats]:
    """Cluster (n,) of each place (n, d), and the first place (k, d) of each; clusters in the order of their first."""
    # slow to import, and not needed to read a design
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    n = len(places)
    if n == 0:
        return np.empty(0, dtype=np.int64), np.empty((0, 2))
    pairs = cKDTree(places).query_pairs(distance, output_type="ndarray")
    label = connected_components(coo_array((np.ones(len(pairs)), pairs.T), shape=(n, n)), directed=False)[1]
    _, first, group = np.unique(label, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return rank[group], places[first[order]]


def off_sheet_mm(area_mm2: float, vertices: int) -> float:
    """Largest distance of points on the edges of a sheet from a mesh of this area with so many vertices.

    >>> round(off_sheet_mm(11_575.0, 3781), 2)
    0.35
    """
    # a vertex on a curved outline is off the chord of another mesh by less than 0.2 mean edges: chords turn by at most
    # 20 degrees, which is a distance of 0.05 chords, and edges of coarser meshes are at most three times as long
    return float(0.2 * np.sqrt(area_mm2 / vertices))
