"""Scans: meshes and point clouds as points in mm."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.compare.errors import ScanError, check_file
from asterism.measure.compare.scan_file import check_scan_file
from asterism.measure.compare.units import MM

SCAN_FORMATS = (".obj", ".stl", ".ply")
MAX_SCAN_POINTS = 20_000
# largest coordinate, in the unit of the file
MAX_SCAN_COORDINATE = 1e9
# points whose width over length is smaller lie on a line
MIN_SCAN_ASPECT = 1e-3


@dataclass(frozen=True)
class Scan:
    """Points on a scanned surface.

    Attributes
    ----------
    points : (n, 3) mm, spread evenly over the surface of a mesh, or a selection of the points of a cloud.
    triangles : number of triangles of the mesh; 0 for a cloud.
    vertices : number of vertices of the file.
    """

    points: Floats
    triangles: int
    vertices: int

    @property
    def size_mm(self) -> float:
        """Largest extent along the principal axes."""
        return extent(self.points)


def extent(points: Floats) -> float:
    """Largest extent (mm) of points (n, 3) along their principal axes."""
    return float(_extents(points)[0])


def _extents(points: Floats) -> Floats:
    """(3,) mm, extents along the principal axes, the largest first."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred.T @ centred)[0]
    return np.asarray(np.sort(np.ptp(centred @ axes, axis=0))[::-1])


def read_scan(path: str | Path, unit: str = "mm", seed: int = 0) -> Scan:
    """Read a scan from an OBJ, STL or PLY file.

    Raises
    ------
    ScanError
        The file is not a scan, or it is empty.
    """
    path = Path(path)
    if path.suffix.lower() not in SCAN_FORMATS:
        raise ScanError(path, f"must end in {', '.join(SCAN_FORMATS)}, or in .svg or .csv for an outline")
    vertices, triangles = _read_checked(path)
    vertices = vertices * MM[unit]
    rng = np.random.default_rng(seed)
    if len(triangles) == 0:
        some = rng.choice(len(vertices), min(len(vertices), MAX_SCAN_POINTS), replace=False)
        points = vertices[np.sort(some)]
    else:
        points = surface_samples(vertices, triangles, MAX_SCAN_POINTS, rng)[0]
    _check_spread(path, points)
    return Scan(points, len(triangles), len(vertices))


def read_surface(path: str | Path) -> tuple[Floats, Ints]:
    """Vertices (V, 3) and triangles (T, 3) of an OBJ, STL or PLY file, in the unit of the file.

    Raises
    ------
    ScanError
        The file holds no surface of triangles.
    """
    path = Path(path)
    if path.suffix.lower() not in SCAN_FORMATS:
        raise ScanError(path, f"must end in {', '.join(SCAN_FORMATS)}")
    vertices, triangles = _read_checked(path)
    if len(triangles) == 0:
        raise ScanError(path, "holds points without triangles: a surface is needed")
    _check_spread(path, surface_samples(vertices, triangles, MAX_SCAN_POINTS, np.random.default_rng(0))[0])
    return vertices, triangles


def _read_checked(path: Path) -> tuple[Floats, Ints]:
    """Vertices and triangles of a file, with finite coordinates."""
    vertices, triangles = _read(path)
    if len(vertices) == 0:
        raise ScanError(path, "holds no points")
    if not np.isfinite(vertices).all() or np.abs(vertices).max() > MAX_SCAN_COORDINATE:
        raise ScanError(path, "holds points that are not finite numbers, or too far away")
    return vertices, triangles


def _check_spread(path: Path, points: Floats) -> None:
    """Raise ScanError unless points (n, 3) spread over a surface."""
    if len(np.unique(points, axis=0)) < 10:
        raise ScanError(path, "holds too few points or triangles to be a surface")
    long, wide, _ = _extents(points)
    if wide <= MIN_SCAN_ASPECT * long:
        raise ScanError(path, "has all its points on one line: a surface is needed")


def surface_samples(vertices: Floats, triangles: Ints, count: int, rng: np.random.Generator) -> tuple[Floats, Ints]:
    """Points (count, 3) spread evenly over triangles, and the triangle (count,) of each; none if they have no area."""
    corners = vertices[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    if not area.sum() > 0:
        return np.empty((0, 3)), np.empty(0, dtype=np.int64)
    # equal steps along the cumulated area give each triangle its share
    where = (np.arange(count) + rng.random(count)) / count * area.sum()
    which = np.minimum(np.searchsorted(np.cumsum(area), where), len(triangles) - 1)
    u, v = rng.random((2, count))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    a, b, c = corners[which].transpose(1, 0, 2)
    return a + u[:, None] * (b - a) + v[:, None] * (c - a), which


def _read(path: Path) -> tuple[Floats, Ints]:
    """Vertices and triangles of all parts of a file, polygons cut into triangles."""
    import trimesh  # slow to import

    check_file(path)
    check_scan_file(path)
    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    try:
        with path.open("rb") as stream, np.errstate(all="ignore"):
            loaded: Any = trimesh.load(stream, file_type=path.suffix[1:].lower(), process=False)
    except (ImportError, UnicodeDecodeError):  # trimesh tries to import a package that guesses encodings
        raise ScanError(path, f"cannot be read as {path.suffix[1:].upper()}: it is not text") from None
    except Exception:  # the parser's texts are for programmers
        problem = f"cannot be read as {path.suffix[1:].upper()}: the file is damaged or cut short"
        raise ScanError(path, problem) from None
    parts: list[Any] = list(loaded.dump()) if isinstance(loaded, trimesh.Scene) else [loaded]
    vertices: list[Floats] = [np.empty((0, 3))]
    triangles: list[Ints] = [np.empty((0, 3), dtype=np.int64)]
    before = 0
    for part in parts:
        points = np.asarray(part.vertices, dtype=float).reshape(-1, 3)
        vertices.append(points)
        triangles.append(np.asarray(getattr(part, "faces", np.empty((0, 3))), dtype=np.int64).reshape(-1, 3) + before)
        before += len(points)
    corners = np.concatenate(triangles)
    if len(corners) and not 0 <= corners.min() <= corners.max() < before:
        raise ScanError(path, "has triangles with corners that it does not hold")
    return np.concatenate(vertices), corners
