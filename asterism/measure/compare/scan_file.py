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


def check_scan_file(path: Path) -> None:
    """Raise ScanError if an OBJ, STL or PLY file is damaged or cut short."""
    content = path.read_bytes()
    {".obj": _check_obj, ".stl": _check_stl, ".ply": _check_ply}[path.suffix.lower()](path, content)


def _check_obj(path: Path, content: bytes) -> None:
    """Every vertex has three numbers: the parser would take them from the following lines."""
    if b"\0" in content:
        raise ScanError(path, "cannot be read as OBJ: it is not text")
    for number, line in enumerate(content.splitlines(), 1):
        words = line.split(b"#")[0].split()
        if not words or words[0] != b"v":
            continue
        if len(words) - 1 < _MIN_COORDINATES:
            raise ScanError(path, f"line {number}: a vertex needs {_MIN_COORDINATES} numbers, not {len(words) - 1}")
        for word in words[1 : 1 + _MIN_COORDINATES]:
            try:
                float(word)
            except ValueError:
                text = word.decode(errors="replace")
                raise ScanError(path, f"line {number}: {text!r} is not a number") from None


def _check_stl(path: Path, content: bytes) -> None:
    """A binary file is as long as its number of triangles requires; a text has its last line."""
    if _is_text(content) and content.lstrip()[:5].lower() == b"solid":
        if b"endsolid" not in content.lower():
            raise ScanError(path, "cannot be read as STL: the file is cut short, its last line is missing")
        return
    if len(content) < _STL_HEADER_BYTES:
        raise ScanError(path, f"cannot be read as STL: it has {len(content)} bytes, a header has {_STL_HEADER_BYTES}")
    count = int.from_bytes(content[80:84], "little")
    present = (len(content) - _STL_HEADER_BYTES) // _STL_TRIANGLE_BYTES
    if present < count:
        raise ScanError(path, f"cannot be read as STL: it holds {present} of {count} triangles; is the file cut short?")


def _check_ply(path: Path, content: bytes) -> None:
    """A text has as many lines as its header announces."""
    head, found, body = content.partition(b"end_header")
    if content[:3] != b"ply" or not found:
        raise ScanError(path, "cannot be read as PLY: it must begin with ply, and its header must end with end_header")
    if not re.search(rb"^format\s+ascii", head, re.MULTILINE):
        return
    announced = sum(int(count) for count in re.findall(rb"^element\s+\S+\s+(\d+)", head, re.MULTILINE))
    present = sum(1 for line in body.splitlines() if line.strip())
    if present < announced:
        raise ScanError(path, f"cannot be read as PLY: it holds {present} of {announced} lines; is the file cut short?")
    vertex = re.search(rb"^element\s+vertex\s+(\d+)\s*((?:^property[^\n]*\n)*)", head, re.MULTILINE)
    if vertex:
        width = len(re.findall(rb"^property", vertex[2], re.MULTILINE))
        lines = [line.split() for line in body.splitlines() if line.strip()][: int(vertex[1])]
        for number, words in enumerate(lines, 1):
            if len(words) != width:
                raise ScanError(path, f"vertex {number}: has {len(words)} numbers, the header announces {width}")


def _is_text(content: bytes) -> bool:
    return b"\0" not in content[:1000]
