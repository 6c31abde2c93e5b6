"""Scans: files of meshes and point clouds, checked and read as points in mm."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats, Ints
from asterism.equilibrium.errors import Error
from asterism.pattern.design.errors import one_line

SCAN_FORMATS = (".obj", ".stl", ".ply")
MAX_SCAN_POINTS = 20_000
# largest coordinate, in the unit of the file
MAX_SCAN_COORDINATE = 1e9
# types of numbers in a header of PLY, in both spellings, as numpy calls them
_TYPES = ("i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8")
_PLY_TYPES = dict(zip(("char", "uchar", "short", "ushort", "int", "uint", "float", "double"), _TYPES, strict=True))
_PLY_TYPES |= zip(("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"), _TYPES, strict=True)
# length of a unit
MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4, "um": 0.001}


class ScanError(Error, ValueError):
    """A scan or an outline cannot be read or compared; the message is one line that begins with the file."""

    def __init__(self, file: str | Path, problem: str):
        super().__init__(one_line(f"{file}: {problem}"))


def check_file(path: Path, error: Callable[[Path, str], Error] = ScanError) -> None:
    """Raise an error unless there is a file."""
    if path.is_dir():
        raise error(path, "is a folder, not a file")
    if not path.is_file():
        raise error(path, "is a pipe or a device, not a file" if path.exists() else "is not there")


@dataclass(frozen=True)
class Scan:
    """Points on a scanned surface."""

    points: Floats  # (n, 3) mm, spread evenly over the surface of a mesh, or a selection of the points of a cloud
    triangles: int  # number of triangles of the mesh; 0 for a cloud
    vertices: int  # number of vertices of the file


def extents(points: Floats) -> Floats:
    """(3,) mm, extents of points (n, 3) along their principal axes, the largest first."""
    centred = points - points.mean(axis=0)
    axes = np.linalg.svd(centred.T @ centred)[0]
    return np.asarray(np.sort(np.ptp(centred @ axes, axis=0))[::-1])


def check_size(file: Path, size_mm: float, expected_mm: float, unit: str | None) -> None:
    """Raise ScanError if the size of a scan cannot be that of the shape; the message names units that fit.

    `unit` is that of the scan's numbers, None for a drawing that gives its size.
    """
    own, unit = unit is None, unit or "mm"
    ratios = {other: size_mm / expected_mm * MM[other] / MM[unit] for other in MM}
    # a scan may show a part, or the table too
    likely = [other for other in sorted(MM, key=lambda o: abs(math.log(ratios[o]))) if 0.25 <= ratios[other] <= 2.0]
    if unit in likely:
        return
    problem = f"is {size_mm / MM[unit]:.4g} {unit} large, the shape {expected_mm:.4g} mm"
    if likely:
        words = {"mm": "millimetres", "cm": "centimetres", "m": "metres", "in": "inches", "um": "micrometres"}
        names = " or ".join(words[other] for other in likely)
        options = "use " + " or ".join(f"--units {other}" for other in likely)
        problem += f": it seems to be in {names}; {'correct its width and height' if own else options}"
    else:
        problem += ", and no known unit fits; is it the right scan, without other objects around the sheet?"
    raise ScanError(file, problem)


def read_scan(path: str | Path, unit: str = "mm") -> Scan:
    """Read a scan from an OBJ, STL or PLY file.

    Raises ScanError: the file is not a scan, or it is empty.
    """
    path = Path(path)
    vertices, triangles = _read(path, ", or in .svg or .csv for an outline")
    vertices = vertices * MM[unit]
    rng = np.random.default_rng(0)
    if len(triangles) == 0:
        some = rng.choice(len(vertices), min(len(vertices), MAX_SCAN_POINTS), replace=False)
        points = vertices[np.sort(some)]
    else:
        points = surface_samples(vertices, triangles, MAX_SCAN_POINTS, rng)[0]
    _check_spread(path, points)
    return Scan(points, len(triangles), len(vertices))


def read_surface(path: str | Path) -> tuple[Floats, Ints]:
    """Vertices (V, 3) and triangles (T, 3) of an OBJ, STL or PLY file, in the unit of the file.

    Raises ScanError: the file holds no surface of triangles.
    """
    path = Path(path)
    vertices, triangles = _read(path)
    if len(triangles) == 0:
        raise ScanError(path, "holds points without triangles: a surface is needed")
    _check_spread(path, surface_samples(vertices, triangles, MAX_SCAN_POINTS, np.random.default_rng(0))[0])
    return vertices, triangles


def _check_spread(path: Path, points: Floats) -> None:
    """Raise ScanError unless points (n, 3) spread over a surface."""
    if len(np.unique(points, axis=0)) < 10:
        raise ScanError(path, "holds too few points or triangles to be a surface")
    long, wide, _ = extents(points)
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


def _read(path: Path, other_formats: str = "") -> tuple[Floats, Ints]:
    """Vertices and triangles of all parts of a file, polygons cut into triangles."""
    from trimesh.geometry import triangulate_quads  # slow to import

    if path.suffix.lower() not in SCAN_FORMATS:
        raise ScanError(path, f"must end in {', '.join(SCAN_FORMATS)}{other_formats}")
    check_file(path)
    read = {".obj": _read_obj, ".stl": _read_stl, ".ply": _read_ply}[path.suffix.lower()]
    try:
        points, faces = read(path, path.read_bytes().removeprefix(b"\xef\xbb\xbf"))
        corners = np.asarray(triangulate_quads(faces), dtype=np.int64).reshape(-1, 3)
    except ScanError:
        raise
    except (ArithmeticError, LookupError, TypeError, ValueError):  # a list in place of a number, and the like
        kind = path.suffix[1:].upper()
        raise ScanError(path, f"cannot be read as {kind}: the file is damaged or cut short") from None
    if len(corners) and not 0 <= corners.min() <= corners.max() < len(points):
        raise ScanError(path, "has triangles with corners that it does not hold")
    if len(points) == 0:
        raise ScanError(path, "holds no points")
    if not np.isfinite(points).all() or np.abs(points).max() > MAX_SCAN_COORDINATE:
        raise ScanError(path, "holds points that are not finite numbers, or too far away")
    return points, corners


def _lines(content: bytes) -> Iterator[tuple[int, list[bytes]]]:
    """Numbers and words of the lines of a text, without comments and empty lines; a wrapped line ends with a stroke."""
    number = 1
    for line in re.sub(rb"\\[ \t]*(\r\n|\r|\n)", b"\v", content).splitlines():
        if words := line.split(b"#")[0].split():
            yield number, words
        number += 1 + line.count(b"\v")


def _read_obj(path: Path, content: bytes) -> tuple[Floats, list[list[int]]]:
    """Places and faces: groups, materials, normals and textures are read over."""
    if b"\0" in content:
        raise ScanError(path, "cannot be read as OBJ: it is not text")
    places: list[list[float]] = []
    faces: list[list[int]] = []
    count = sum(words[0] == b"v" for _, words in _lines(content))
    allowed = f"vertices are numbered from 1 to {count}" if count else "the file has no vertices"
    for line, words in _lines(content):
        if words[0] == b"v":
            places.append(_place(path, line, words))
        elif words[0] == b"f":
            if len(words) < 4:
                raise ScanError(path, f"line {line}: a face needs 3 corners, not {len(words) - 1}")
            face = []
            for corner in words[1:]:  # such as 7 or 7/2/3; -1 is the last vertex before
                try:
                    vertex = int(corner.split(b"/")[0])
                except ValueError:
                    raise ScanError(path, f"line {line}: {_shown(corner)} is no number of a vertex") from None
                face.append(vertex - 1 if vertex > 0 else len(places) + vertex if vertex else -1)
                if not 0 <= face[-1] < count:
                    raise ScanError(path, f"line {line}: the face has the vertex {vertex}, but {allowed}")
            faces.append(face)
    return np.array(places, dtype=float).reshape(-1, 3), faces


def _place(path: Path, line: int, words: list[bytes]) -> list[float]:
    """A vertex begins with three numbers; a fourth is a weight, and six are a place and a colour."""
    if len(words) < 4:
        raise ScanError(path, f"line {line}: a vertex needs 3 numbers, not {len(words) - 1}")
    return _numbers(path, f"line {line}", words[1:4])


def _numbers(path: Path, where: str, words: list[bytes]) -> list[float]:
    numbers = []
    for word in words:
        try:
            numbers.append(float(word))
        except ValueError:
            raise ScanError(path, f"{where}: {_shown(word)} is not a number") from None
    return numbers


def _read_stl(path: Path, content: bytes) -> tuple[Floats, Ints]:
    """The triangles of a text, whose last line must be there, or of a binary file, which may hold more bytes."""
    # 80 bytes of text, the number of triangles, and 50 bytes for each of them
    count, present = int.from_bytes(content[80:84], "little"), (len(content) - 84) / 50
    if present != count and b"\0" not in content[:1000] and content.lstrip()[:5].lower() == b"solid":
        if b"endsolid" not in content.lower():
            raise ScanError(path, "cannot be read as STL: the file is cut short, its last line is missing")
        places: list[list[float]] = []
        before = 0
        for line, words in _lines(content):
            if words[0].lower() == b"vertex":
                places.append(_place(path, line, words))
            elif words[0].lower() == b"endloop":
                if len(places) != before + 3:
                    raise ScanError(path, f"line {line}: a triangle needs 3 vertices, not {len(places) - before}")
                before = len(places)
        vertices = np.array(places[:before], dtype=float).reshape(-1, 3)
    else:
        if len(content) < 84:
            raise ScanError(path, f"cannot be read as STL: it has {len(content)} bytes, a header has 84")
        if present < count:
            problem = f"it holds {int(present)} of {count} triangles; is the file cut short?"
            raise ScanError(path, f"cannot be read as STL: {problem}")
        facet = [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
        vertices = np.frombuffer(content, facet, count, 84)["corners"].reshape(-1, 3).astype(float)
    return vertices, np.arange(len(vertices)).reshape(-1, 3)


def _read_ply(path: Path, content: bytes) -> tuple[Floats, list[Any]]:
    """Places and faces of a text, or of a binary file; what else its header announces is read over."""
    parts = re.match(rb"(ply\s.*?[\r\n])end_header[ \t]*(?:\r\n|\r|\n|$)(.*)", content, re.DOTALL)
    if parts is None:
        raise ScanError(path, "cannot be read as PLY: it must begin with ply, and its header must end with end_header")
    form, elements = "", list[_Element]()
    for line in parts[1].decode(errors="replace").splitlines():
        match line.split():
            case ["format", form, *_]:
                pass
            case ["element", name, count] if count.isdecimal():
                elements.append(_Element(name, int(count), []))
            case ["property", *kinds, name] if elements and len(kinds) == (3 if kinds[:1] == ["list"] else 1):
                if odd := next((kind for kind in kinds if kind != "list" and kind not in _PLY_TYPES), None):
                    known = ", ".join(list(_PLY_TYPES)[:8])
                    raise ScanError(path, f"cannot be read as PLY: its header has the type {odd!r}; there are {known}")
                elements[-1].properties.append((name, [_PLY_TYPES[kind] for kind in kinds if kind != "list"]))
    orders = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
    if form not in orders:
        raise ScanError(path, f"cannot be read as PLY: its format is {form!r}; there are {', '.join(orders)}")
    found = _ply_columns(path, elements, parts[2], orders[form])
    columns = [found.get(("vertex", name), []) for name in "xyz"]
    faces: Any = next(
        (found["face", name] for name in ("vertex_indices", "vertex_index") if ("face", name) in found), []
    )
    if len({len(column) for column in columns}) > 1:
        raise ScanError(path, "cannot be read as PLY: its vertices need x, y and z")
    return np.column_stack(columns).astype(float).reshape(-1, 3), [face for face in faces if len(face) > 2]


@dataclass(frozen=True)
class _Element:
    """What a header of PLY announces: properties have one type, or if they are lists that of their length first."""

    name: str
    count: int
    properties: list[tuple[str, list[str]]]


def _ply_columns(path: Path, elements: list[_Element], body: bytes, order: str) -> dict[tuple[str, str], Any]:
    """The values of each element and property; without a byte order of a text, which has one line an element."""
    lines = [] if order else [line.split() for line in body.splitlines() if line.strip()]
    announced = sum(element.count for element in elements)
    if not order and len(lines) < announced:
        problem = f"it holds {len(lines)} of {announced} lines; is the file cut short?"
        raise ScanError(path, f"cannot be read as PLY: {problem}")
    found: dict[tuple[str, str], Any] = {
        (element.name, name): [] for element in elements for name, _ in element.properties
    }
    rest, row, start = iter(lines), list[float](), 0

    def take(kind: str, count: int) -> Any:
        nonlocal start
        begin, start = start, start + count * (np.dtype(kind).itemsize if order else 1)
        if not order:
            return row[begin:start]
        if not 0 <= count <= start <= len(body):
            raise ScanError(path, "cannot be read as PLY: the file is damaged or cut short")
        return np.frombuffer(body, order + kind, count, begin)

    for element in elements:
        if order and all(len(kinds) == 1 for _, kinds in element.properties):
            kind = np.dtype([(name, order + kinds[0]) for name, kinds in element.properties])
            table = take("V1", element.count * kind.itemsize).view(kind)
            found |= {(element.name, name): table[name] for name, _ in element.properties}
            continue
        for number in range(1, element.count + 1):
            where = f"{element.name} {number}"
            if not order:
                row, start = _numbers(path, where, next(rest)), 0
            for name, kinds in element.properties:
                is_list = len(kinds) == 2
                values = take(kinds[-1], int(take(kinds[0], 1)[0]) if is_list else 1)
                found[element.name, name].append(values if is_list else sum(values))
            if not order and start != len(row):
                raise ScanError(path, f"{where}: has {len(row)} numbers, the file announces {start}")
    return found


def _shown(word: bytes) -> str:
    return repr(word.decode(errors="replace"))
