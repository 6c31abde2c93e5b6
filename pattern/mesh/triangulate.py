"""The only call of the `triangle` package. Its C code ends the process on bad input, so all input is checked first."""

from __future__ import annotations

import numpy as np
import shapely
import triangle
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from asterism.equilibrium.arrays import Floats, Ints
from asterism.pattern.design.errors import MeshError
from asterism.pattern.geometry.planar import distance_to_segment, is_in_sorted, triangle_areas

# closer than this, relative to the extent of the input, points count as one and segments as touching
COINCIDENCE_TOLERANCE = 1e-8
MAX_ADDED_POINTS = 2_000_000


def triangulate(
    points: ArrayLike,
    segments: ArrayLike,
    *,
    min_angle_deg: float | None = None,
    max_area: float | None = None,
    holes: ArrayLike = (),
) -> tuple[Floats, Ints]:
    """Constrained Delaunay triangulation of the region that closed loops of segments enclose.

    Segments are never split. Refinement adds points inside only, so that triangles at the segments may miss the angle
    and the area asked for. Raises `MeshError` if the input is not such a set of points and segments, or the mesh would
    be too large.

    Parameters
    ----------
    points : (n, 2), distinct, none on a segment it does not end.
    segments : (m, 2) indices of points; they may meet at points only.
    min_angle_deg : smallest angle to aim for, at most 33.
    max_area : largest area of a triangle, in units of `points` squared.
    holes : (h, 2), one point in each hole.

    Returns
    -------
    points : (N, 2), N >= n; the first n are those given, bit for bit.
    triangles : (T, 3), counterclockwise.
    """
    p, s, h = _arrays(points, segments, holes)
    centre = (p.min(axis=0) + p.max(axis=0)) / 2
    scale = float(np.ptp(p, axis=0).max())
    if not scale > 1e-9 * float(np.abs(p).max()):
        raise MeshError("the points to triangulate coincide, or lie too far from the origin to tell apart")
    # Triangle's exact arithmetic is only exact far from overflow and underflow
    unit = (p - centre) / scale
    holes_at = (h - centre) / scale
    _check_geometry(unit, s)
    area = _enclosed_area(unit, s, holes_at)
    options, room = "p", 20.0 * len(p)
    if min_angle_deg is not None:
        options += f"q{min_angle_deg:.6f}"
    if max_area is not None:
        options += f"a{max_area / scale**2:.20f}"
        room += 2 * np.prod(np.ptp(unit, axis=0)) * scale**2 / max_area
    if options != "p" and room > MAX_ADDED_POINTS:
        raise MeshError(f"about {room:.2g} points would be added, more than {MAX_ADDED_POINTS}: use a longer edge")
    if options != "p":
        options += f"YYS{int(room)}"
    data = {"vertices": unit, "segments": s.astype(np.int32)}
    if len(h):
        data["holes"] = holes_at
    result = triangle.triangulate(data, options)
    mesh, triangles = np.asarray(result["vertices"]), np.asarray(result.get("triangles", ()), dtype=np.int64)
    if len(mesh) - len(p) >= int(room):
        raise MeshError(f"the mesh would need more than {int(room)} points: use a longer edge")
    _check_result(mesh, triangles.reshape(-1, 3), s, area)
    return np.concatenate([p, mesh[len(p) :] * scale + centre]), triangles


def _arrays(points: ArrayLike, segments: ArrayLike, holes: ArrayLike) -> tuple[Floats, Ints, Floats]:
    """The input as arrays, finite and with indices in range."""
    p, h = (np.array(each, dtype=float).reshape(-1, 2) for each in (points, holes))
    s = np.array(segments, dtype=np.int64).reshape(-1, 2)
    if len(p) < 3 or len(s) < 3:
        raise MeshError("a triangulation needs at least three points and three segments")
    if not (np.isfinite(p).all() and np.isfinite(h).all()):
        raise MeshError("points and holes must be finite")
    if not (1e-100 < np.abs(p).max() < 1e100):
        raise MeshError("points must be between 1e-100 and 1e100 in size")
    if s.min() < 0 or s.max() >= len(p):
        raise MeshError(f"segments must name points 0 to {len(p) - 1}, got {s.min()} to {s.max()}")
    return p, s.astype(np.int64), h.reshape(-1, 2)


def _check_geometry(p: Floats, s: Ints) -> None:
    """Refuse points that are not distinct, and segments that meet elsewhere than at points."""
    same = cKDTree(p).query_pairs(COINCIDENCE_TOLERANCE)
    if same:
        i, j = min(same)
        raise MeshError(f"points {i} and {j} are the same")
    spread = np.linalg.svd(p - p.mean(axis=0), compute_uv=False)
    if spread[1] < COINCIDENCE_TOLERANCE * spread[0]:
        raise MeshError("the points lie on one line")
    if (s[:, 0] == s[:, 1]).any():
        raise MeshError(f"segment {np.argmax(s[:, 0] == s[:, 1])} has no length")
    if len(np.unique(_codes(s, len(p)))) < len(s):
        raise MeshError("a segment is given twice")
    lines = shapely.linestrings(p[s])
    # pairs whose boxes meet, without the many that belong together, before their geometry is looked at
    low, high = p[s].min(axis=1) - COINCIDENCE_TOLERANCE, p[s].max(axis=1) + COINCIDENCE_TOLERANCE
    owner, on = shapely.STRtree(shapely.points(p)).query(shapely.box(*low.T, *high.T))
    other = (s[owner] != on[:, None]).all(axis=1)
    owner, on = owner[other], on[other]
    touching = np.flatnonzero(distance_to_segment(p[on], p[s[owner, 0]], p[s[owner, 1]]) <= COINCIDENCE_TOLERANCE)
    if len(touching):
        k = touching[0]
        raise MeshError(f"point {on[k]} lies on segment {owner[k]} between its ends")
    first, second = shapely.STRtree(lines).query(lines)
    # segments with a common end cannot cross: each has the other's end beside it only by rounding
    apart = (s[first][:, :, None] != s[second][:, None, :]).all(axis=(1, 2))
    first, second = first[apart], second[apart]
    crossing = np.flatnonzero(shapely.crosses(lines[first], lines[second]))
    if len(crossing):
        k = crossing[0]
        raise MeshError(f"segments {first[k]} and {second[k]} cross")


def _enclosed_area(p: Floats, s: Ints, holes: Floats) -> float:
    """The area that the segments enclose without the holes; each hole must be inside a loop of its own."""
    faces = shapely.get_parts(shapely.polygonize(shapely.linestrings(p[s])))
    if len(holes):
        inside, face = shapely.STRtree(faces).query(shapely.points(holes), predicate="within")
        beside = distance_to_segment(holes[:, None], *p[s].swapaxes(0, 1)).min(axis=1) <= COINCIDENCE_TOLERANCE
        bad = np.isin(np.arange(len(holes)), inside, invert=True) | beside
        if bad.any():
            raise MeshError(f"hole {np.argmax(bad)} is not inside a loop of segments")
        faces = np.delete(faces, face)
    if not len(faces):
        raise MeshError("the segments enclose no region")
    return float(shapely.area(faces).sum())


def _check_result(p: Floats, t: Ints, s: Ints, area: float) -> None:
    """Triangles turn counterclockwise, fill the area, use every point, contain every segment and end at segments."""
    areas = triangle_areas(p, t) if len(t) else np.zeros(1)
    if not np.isfinite(p).all() or areas.min() <= 0 or abs(areas.sum() - area) > 1e-9 + 1e-6 * area:
        raise MeshError("the mesh does not fill what the segments enclose")
    edges, count = _edges(t, len(p))
    codes = _codes(s, len(p))
    used = np.bincount(t.ravel(), minlength=len(p)) > 0
    if not (
        used.all()
        and is_in_sorted(codes, edges).all()
        and is_in_sorted(edges[count == 1], np.sort(codes)).all()
        and count.max() <= 2
    ):
        raise MeshError("points or segments lie outside what the segments enclose")


def _codes(pairs: Ints, n: int) -> Ints:
    """One number for every unordered pair of indices below n."""
    one, two = pairs.T
    return np.asarray(np.minimum(one, two) * n + np.maximum(one, two))


def _edges(t: Ints, n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Codes of the edges of triangles, and how many triangles have each."""
    return np.unique(_codes(np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]]), n), return_counts=True)
