"""Checks of a scan's file before it is parsed: the parser accepts damaged files, and reads other places from them."""

from __future__ import annotations

import re
from pathlib import Path

from asterism.measure.compare.errors import ScanError

# bytes of a binary STL: header with the number of triangles, and one triangle
_STL_HEADER_BYTES = 84
_STL_TRIANGLE_BYTES = 50
# x, y, z; a fourth number is a weight, and six numbers are a place and a colour
_MIN_COORDINATES = 3
# names of the types of numbers in a header of PLY, in both spellings
_PLY_TYPES = {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"}
_PLY_TYPES |= {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"}


def check_scan_file(path: Path) -> None:
    """Raise ScanError if an OBJ, STL or PLY file is damaged or cut short."""
    content = path.read_bytes()
    {".obj": _check_obj, ".stl": _check_stl, ".ply": _check_ply}[path.suffix.lower()](path, content)


def _check_obj(path: Path, content: bytes) -> None:
    """Every vertex has three numbers, or the parser takes them from the next lines; faces have vertices that exist."""
    if b"\0" in content:
        raise ScanError(path, "cannot be read as OBJ: it is not text")
    faces: list[tuple[int, list[bytes]]] = []
    vertices = 0
    for number, line in enumerate(content.splitlines(), 1):
        words = line.split(b"#")[0].split()
        if not words:
            continue
        if words[0] == b"v":
            vertices += 1
            _check_place(path, number, words[1:])
        elif words[0] == b"f":
            faces.append((number, words[1:]))
    for number, corners in faces:
        if len(corners) < 3:
            raise ScanError(path, f"line {number}: a face needs 3 corners, not {len(corners)}")
        for corner in corners:
            _check_corner(path, number, corner, vertices)


def _check_corner(path: Path, line: int, corner: bytes, vertices: int) -> None:
    """A corner of a face, such as 7 or 7/2/3, counts vertices from 1, or from the last one backwards as -1."""
    try:
        vertex = int(corner.split(b"/")[0])
    except ValueError:
        raise ScanError(path, f"line {line}: {_shown(corner)} is no number of a vertex") from None
    if not 1 <= abs(vertex) <= vertices:
        allowed = f"vertices are numbered from 1 to {vertices}" if vertices else "the file has no vertices"
        raise ScanError(path, f"line {line}: the face has the vertex {vertex}, but {allowed}")


def _check_place(path: Path, line: int, words: list[bytes]) -> None:
    """Three numbers at the beginning of a vertex."""
    if len(words) < _MIN_COORDINATES:
        raise ScanError(path, f"line {line}: a vertex needs {_MIN_COORDINATES} numbers, not {len(words)}")
    _check_numbers(path, f"line {line}", words[:_MIN_COORDINATES])


def _check_numbers(path: Path, where: str, words: list[bytes]) -> None:
    for word in words:
        try:
            float(word)
        except ValueError:
            raise ScanError(path, f"{where}: {_shown(word)} is not a number") from None


def _check_stl(path: Path, content: bytes) -> None:
    """A binary file is as long as its number of triangles requires; a text has whole vertices and its last line."""
    if _is_text(content) and content.lstrip()[:5].lower() == b"solid":
        if b"endsolid" not in content.lower():
            raise ScanError(path, "cannot be read as STL: the file is cut short, its last line is missing")
        _check_stl_text(path, content)
        return
    if len(content) < _STL_HEADER_BYTES:
        raise ScanError(path, f"cannot be read as STL: it has {len(content)} bytes, a header has {_STL_HEADER_BYTES}")
    count = int.from_bytes(content[80:84], "little")
    present = (len(content) - _STL_HEADER_BYTES) // _STL_TRIANGLE_BYTES
    if present < count:
        raise ScanError(path, f"cannot be read as STL: it holds {present} of {count} triangles; is the file cut short?")


def _check_stl_text(path: Path, content: bytes) -> None:
    """Every loop of a text has three vertices."""
    corners = 0
    for number, line in enumerate(content.splitlines(), 1):
        words = line.split()
        if not words:
            continue
        if words[0].lower() == b"vertex":
            corners += 1
            _check_place(path, number, words[1:])
        elif words[0].lower() == b"endloop":
            if corners != 3:
                raise ScanError(path, f"line {number}: a triangle needs 3 vertices, not {corners}")
            corners = 0


def _check_ply(path: Path, content: bytes) -> None:
    """A header names types that exist; a text has as many lines as its header announces, and each is complete."""
    head, separator, body = content.partition(b"end_header")
    if content[:3] != b"ply" or not separator:
        raise ScanError(path, "cannot be read as PLY: it must begin with ply, and its header must end with end_header")
    for kind in re.findall(rb"^property\s+(?:list\s+(?:\S+)\s+)?(\S+)", head, re.MULTILINE):
        if kind.decode(errors="replace") not in _PLY_TYPES:
            allowed = "char, uchar, short, ushort, int, uint, float and double"
            raise ScanError(path, f"cannot be read as PLY: its header has the type {_shown(kind)}; there are {allowed}")
    if not re.search(rb"^format\s+ascii", head, re.MULTILINE):
        return
    lines = [line.split() for line in body.splitlines() if line.strip()]
    elements = re.findall(rb"^element\s+(\S+)\s+(\d+)\s*((?:^(?:property|comment)[^\n]*\n)*)", head, re.MULTILINE)
    announced = sum(int(count) for _, count, _ in elements)
    if len(lines) < announced:
        problem = f"it holds {len(lines)} of {announced} lines; is the file cut short?"
        raise ScanError(path, f"cannot be read as PLY: {problem}")
    begin = 0
    for name, count, properties in elements:
        plain = len(re.findall(rb"^property\s+(?!list)", properties, re.MULTILINE))
        lists = len(re.findall(rb"^property\s+list", properties, re.MULTILINE))
        for number, words in enumerate(lines[begin : begin + int(count)], 1):
            _check_element(path, f"{name.decode(errors='replace')} {number}", words, plain, lists)
        begin += int(count)


def _check_element(path: Path, where: str, words: list[bytes], plain: int, lists: int) -> None:
    """A line of a PLY text has its plain numbers, and after the length of a list the list."""
    _check_numbers(path, where, words)
    needed = plain
    if lists == 1 and plain == 0:
        needed = 1 + int(float(words[0]))
    elif lists:
        return  # lists among other numbers may stand anywhere in the line
    if len(words) != needed:
        raise ScanError(path, f"{where}: has {len(words)} numbers, the file announces {needed}")


def _shown(word: bytes) -> str:
    return repr(word.decode(errors="replace"))


def _is_text(content: bytes) -> bool:
    return b"\0" not in content[:1000]
