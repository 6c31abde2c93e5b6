"""Damaged files of scans are refused with their place; intact ones are read."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np
import pytest

from asterism.measure.compare.errors import ScanError
from asterism.measure.compare.scan import read_scan

PLY = "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\nend_header\n"


def points() -> list[str]:
    return [f"{x} {y} {0.1 * x * y}" for x in range(4) for y in range(3)]


@pytest.mark.parametrize("line", ["v 1 2", "v 1", "v", "v 1 2 x"])
@pytest.mark.parametrize("copies", [1, 3])
def test_a_short_vertex_of_an_obj_is_named(line: str, copies: int, tmp_path: Path) -> None:
    """Three short lines of two numbers make two vertices for a parser that only counts numbers."""
    file = tmp_path / "a.obj"
    file.write_text("\n".join([f"v {point}" for point in points()] + copies * [line]))
    with pytest.raises(ScanError, match="line 13"):
        read_scan(file)


def obj_with(face: str) -> str:
    return "\n".join([*(f"v {point}" for point in points()), "f 1 2 3", face])


@pytest.mark.parametrize(
    ("face", "expected"),
    [
        ("f 0 1 2", "line 14: the face has the vertex 0, but vertices are numbered from 1 to 12"),
        ("f 1 2 13", "line 14: the face has the vertex 13"),
        ("f 1 -13 2", "line 14: the face has the vertex -13"),
        ("f 1 x 2", "line 14: 'x' is no number of a vertex"),
        ("f 1 2", "line 14: a face needs 3 corners, not 2"),
    ],
)
def test_a_wrong_face_of_an_obj_is_named(face: str, expected: str, tmp_path: Path) -> None:
    file = tmp_path / "a.obj"
    file.write_text(obj_with(face))
    with pytest.raises(ScanError, match=re.escape(expected)):
        read_scan(file)


def test_faces_of_an_obj_may_name_textures_and_count_backwards(tmp_path: Path) -> None:
    file = tmp_path / "a.obj"
    file.write_text(obj_with("f 4/1/1 5//2 -1"))
    assert read_scan(file).triangles == 2


@pytest.mark.parametrize(
    ("face", "expected"),
    [("3 0 1", "face 2: has 3 numbers, the file announces 4"), ("3 0 x 1", "face 2: 'x' is not a number")],
)
def test_a_face_of_a_ply_that_is_cut_short_is_named(face: str, expected: str, tmp_path: Path) -> None:
    file = tmp_path / "a.ply"
    head = PLY.replace("end_header", "element face 2\nproperty list uchar int vertex_indices\nend_header")
    file.write_text(head + "\n".join([*points(), "3 0 1 4", "3 1 2 5"]) + "\n")
    assert read_scan(file).triangles == 2
    file.write_text(head + "\n".join([*points(), "3 0 1 4", face]) + "\n")
    with pytest.raises(ScanError, match=expected):
        read_scan(file)


def test_a_type_that_ply_does_not_have_is_named(tmp_path: Path) -> None:
    file = tmp_path / "a.ply"
    file.write_text(PLY.replace("float y", "flooat y") + "\n".join(points()) + "\n")
    with pytest.raises(ScanError, match="'flooat'; there are char, uchar"):
        read_scan(file)


def test_a_binary_ply_that_is_cut_short_is_refused_in_our_words(tmp_path: Path) -> None:
    file = tmp_path / "a.ply"
    file.write_bytes(PLY.replace("ascii", "binary_little_endian").encode() + np.zeros(30, dtype="<f4").tobytes())
    with pytest.raises(ScanError, match="cannot be read as PLY: the file is damaged or cut short"):
        read_scan(file)


@pytest.mark.parametrize(
    ("vertices", "expected"),
    [(["0 0 0", "1 0 x", "0 1 0"], "line 5: 'x' is not a number"), (["0 0 0", "1 0 0"], "line 6: a triangle needs 3")],
)
def test_a_wrong_triangle_of_an_stl_text_is_named(vertices: list[str], expected: str, tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    loop = ["outer loop", *(f"vertex {vertex}" for vertex in vertices), "endloop"]
    file.write_text("\n".join(["solid a", "facet normal 0 0 1", *loop, "endfacet", "endsolid a"]))
    with pytest.raises(ScanError, match=expected):
        read_scan(file)


def test_weights_and_colours_of_an_obj_are_read_over(tmp_path: Path) -> None:
    file = tmp_path / "a.obj"
    file.write_text("\n".join(f"v {point} 0.5 0.5 0.5" for point in points()))
    assert read_scan(file).vertices == 12


def test_a_ply_text_that_is_cut_short_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.ply"
    file.write_text(PLY + "\n".join(points()) + "\n")
    assert read_scan(file).vertices == 12
    file.write_text(PLY + "\n".join(points()[:7]) + "\n")
    with pytest.raises(ScanError, match="7 of 12"):
        read_scan(file)
    file.write_text(PLY + "\n".join([*points()[:-1], "1 2"]) + "\n")
    with pytest.raises(ScanError, match="vertex 12"):
        read_scan(file)


def test_a_binary_stl_that_is_cut_short_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    rng = np.random.default_rng(0)
    content = bytes(80) + struct.pack("<I", 20)
    content += b"".join(struct.pack("<12fH", *rng.normal(size=12), 0) for _ in range(20))
    file.write_bytes(content)
    assert read_scan(file).triangles == 20
    file.write_bytes(content[:500])
    with pytest.raises(ScanError, match="8 of 20 triangles"):
        read_scan(file)
