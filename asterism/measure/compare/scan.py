"""Scans: files of meshes and point clouds, checked and read as points in mm."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.compare.errors import ScanError, check_file
from asterism.measure.compare.units import MM

SCAN_FORMATS = (".obj", ".stl", ".ply")
MAX_SCAN_POINTS = 20_000
# largest coordinate, in the unit of the file
MAX_SCAN_COORDINATE = 1e9
# types of numbers in a header of PLY, in both spellings
_PLY_TYPES = ("char", "uchar", "short", "ushort", "int", "uint", "float", "double")
_PLY_BIT_TYPES = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")


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
    vertices, triangles = _read(path)
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
    vertices, triangles = _read(path)
    if len(triangles) == 0:
        raise ScanError(path, "holds points without triangles: a surface is needed")
    _check_spread(path, surface_samples(vertices, triangles, MAX_SCAN_POINTS, np.random.default_rng(0))[0])
    return vertices, triangles


def _check_spread(path: Path, points: Floats) -> None:
    """Raise ScanError unless points (n, 3) spread over a surface."""
    if len(np.unique(points, axis=0)) < 10:
        raise ScanError(path, "holds too few points or triangles to be a surface")
    long, wide, _ = _extents(points)
    if wide <= 1e-3 * long:
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
    kind, content = path.suffix[1:].upper(), path.read_bytes()
    # the parser accepts damaged files, and reads other places from them
    {"OBJ": _check_obj, "STL": _check_stl, "PLY": _check_ply}[kind](path, content)
    logging.getLogger("trimesh").setLevel(logging.CRITICAL)
    try:
        with path.open("rb") as stream, np.errstate(all="ignore"):
            loaded: Any = trimesh.load(stream, file_type=kind.lower(), process=False)
    except (ImportError, UnicodeDecodeError):  # trimesh tries to import a package that guesses encodings
        raise ScanError(path, f"cannot be read as {kind}: it is not text") from None
    except Exception:  # the parser's texts are for programmers
        raise ScanError(path, f"cannot be read as {kind}: the file is damaged or cut short") from None
    parts: list[Any] = list(loaded.dump()) if isinstance(loaded, trimesh.Scene) else [loaded]
    vertices, triangles = [np.empty((0, 3))], [np.empty((0, 3), dtype=np.int64)]
    before = 0
    for part in parts:
        vertices.append(np.asarray(part.vertices, dtype=float).reshape(-1, 3))
        triangles.append(np.asarray(getattr(part, "faces", []), dtype=np.int64).reshape(-1, 3) + before)
        before += len(vertices[-1])
    points, corners = np.concatenate(vertices), np.concatenate(triangles)
    if len(corners) and not 0 <= corners.min() <= corners.max() < before:
        raise ScanError(path, "has triangles with corners that it does not hold")
    if before == 0:
        raise ScanError(path, "holds no points")
    if not np.isfinite(points).all() or np.abs(points).max() > MAX_SCAN_COORDINATE:
        raise ScanError(path, "holds points that are not finite numbers, or too far away")
    return points, corners


def _lines(content: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Numbers and words of the lines of a text, without comments and empty lines."""
    for number, line in enumerate(content.splitlines(), 1):
        if words := line.split(b"#")[0].split():
            yield number, words


def _check_obj(path: Path, content: bytes) -> None:
    """Every vertex has three numbers, or the parser takes them from the next lines; faces have vertices that exist."""
    if b"\0" in content:
        raise ScanError(path, "cannot be read as OBJ: it is not text")
    vertices = sum(words[0] == b"v" for _, words in _lines(content))
    for line, words in _lines(content):
        if words[0] == b"v":
            _check_place(path, line, words[1:])
        elif words[0] == b"f":
            if len(words) < 4:
                raise ScanError(path, f"line {line}: a face needs 3 corners, not {len(words) - 1}")
            for corner in words[1:]:  # such as 7 or 7/2/3; -1 is the last vertex
                try:
                    vertex = int(corner.split(b"/")[0])
                except ValueError:
                    raise ScanError(path, f"line {line}: {_shown(corner)} is no number of a vertex") from None
                if not 1 <= abs(vertex) <= vertices:
                    allowed = f"vertices are numbered from 1 to {vertices}" if vertices else "the file has no vertices"
                    raise ScanError(path, f"line {line}: the face has the vertex {vertex}, but {allowed}")


def _check_place(path: Path, line: int, words: list[bytes]) -> None:
    """A vertex begins with three numbers; a fourth is a weight, and six are a place and a colour."""
    if len(words) < 3:
        raise ScanError(path, f"line {line}: a vertex needs 3 numbers, not {len(words)}")
    _check_numbers(path, f"line {line}", words[:3])


def _check_numbers(path: Path, where: str, words: list[bytes]) -> None:
    for word in words:
        try:
            float(word)
        except ValueError:
            raise ScanError(path, f"{where}: {_shown(word)} is not a number") from None


def _check_stl(path: Path, content: bytes) -> None:
    """A binary file is as long as its number of triangles requires; a text has whole triangles and its last line."""
    if b"\0" not in content[:1000] and content.lstrip()[:5].lower() == b"solid":
        if b"endsolid" not in content.lower():
            raise ScanError(path, "cannot be read as STL: the file is cut short, its last line is missing")
        corners = 0
        for line, words in _lines(content):
            if words[0].lower() == b"vertex":
                corners += 1
                _check_place(path, line, words[1:])
            elif words[0].lower() == b"endloop":
                if corners != 3:
                    raise ScanError(path, f"line {line}: a triangle needs 3 vertices, not {corners}")
                corners = 0
        return
    # 80 bytes of text, the number of triangles, and 50 bytes for each of them
    if len(content) < 84:
        raise ScanError(path, f"cannot be read as STL: it has {len(content)} bytes, a header has 84")
    count, present = int.from_bytes(content[80:84], "little"), (len(content) - 84) // 50
    if present < count:
        raise ScanError(path, f"cannot be read as STL: it holds {present} of {count} triangles; is the file cut short?")


def _check_ply(path: Path, content: bytes) -> None:
    """A header names types that exist; a text has as many lines as its header announces, and each is complete."""
    head, separator, body = content.partition(b"end_header")
    if content[:3] != b"ply" or not separator:
        raise ScanError(path, "cannot be read as PLY: it must begin with ply, and its header must end with end_header")
    for kind in re.findall(rb"^property\s+(?:list\s+(?:\S+)\s+)?(\S+)", head, re.MULTILINE):
        if kind.decode(errors="replace") not in _PLY_TYPES + _PLY_BIT_TYPES:
            problem = f"its header has the type {_shown(kind)}; there are {', '.join(_PLY_TYPES)}"
            raise ScanError(path, f"cannot be read as PLY: {problem}")
    if not re.search(rb"^format\s+ascii", head, re.MULTILINE):
        return
    lines = [line.split() for line in body.splitlines() if line.strip()]
    elements = re.findall(rb"^element\s+(\S+)\s+(\d+)\s*((?:^(?:property|comment)[^\n]*\n)*)", head, re.MULTILINE)
    announced = sum(int(count) for _, count, _ in elements)
    if len(lines) < announced:
        problem = f"it holds {len(lines)} of {announced} lines; is the file cut short?"
        raise ScanError(path, f"cannot be read as PLY: {problem}")
    rest = iter(lines)
    for name, count, properties in elements:
        kinds = re.findall(rb"^property\s+(list)?", properties, re.MULTILINE)
        for number, words in zip(range(1, int(count) + 1), rest, strict=False):
            where = f"{name.decode(errors='replace')} {number}"
            _check_numbers(path, where, words)
            # a list begins with its length; lists among other numbers may stand anywhere in the line
            needed = 1 + int(float(words[0])) if kinds == [b"list"] else len(words) if b"list" in kinds else len(kinds)
            if len(words) != needed:
                raise ScanError(path, f"{where}: has {len(words)} numbers, the file announces {needed}")


def _shown(word: bytes) -> str:
    return repr(word.decode(errors="replace"))
