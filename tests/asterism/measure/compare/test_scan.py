"""Files of scans and of outlines: what is read, one line for everything else. An outline is laid on a silhouette."""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh

from asterism.measure.outline import fit_outline, read_outline, silhouette
from asterism.measure.scan import ScanError, check_size, extents, read_scan, read_surface, surface_samples
from asterism.results.csv_table import TableError
from tests.asterism.measure.compare.scans import bent_sheet
from tests.asterism.sheets import dome, flat, sheet, tube

SHAPE = bent_sheet(5.0)
MESH = trimesh.Trimesh(SHAPE.positions, SHAPE.triangles, process=False)


@pytest.mark.parametrize("name", ["a.obj", "a.stl", "a.ply", "A.OBJ"])
def test_meshes(name: str, tmp_path: Path) -> None:
    MESH.export(tmp_path / name, file_type=name[-3:].lower())
    vertices, triangles = read_surface(tmp_path / name)
    assert vertices[triangles] == pytest.approx(SHAPE.positions[SHAPE.triangles], abs=1e-5)
    scan = read_scan(tmp_path / name)
    assert scan.triangles == len(SHAPE.triangles)
    assert extents(scan.points) == pytest.approx(extents(SHAPE.positions), rel=0.05)
    assert len(scan.points) == 20_000


@pytest.mark.parametrize("name", ["a.obj", "a.ply"])
def test_clouds(name: str, tmp_path: Path) -> None:
    trimesh.PointCloud(SHAPE.positions).export(tmp_path / name)
    scan = read_scan(tmp_path / name, "cm")
    assert scan.triangles == 0 and len(scan.points) == len(SHAPE.positions)
    places = np.sort(SHAPE.positions, axis=0)
    np.testing.assert_allclose(np.sort(scan.points, axis=0), 10 * places, rtol=1e-6, atol=1e-4)


def test_samples_are_spread_by_area() -> None:
    points, which = surface_samples(SHAPE.positions, SHAPE.triangles, 50_000, np.random.default_rng(0))
    share = np.bincount(which, minlength=len(SHAPE.triangles)) / len(points)
    np.testing.assert_allclose(share, MESH.area_faces / MESH.area, atol=4.1e-5)
    nearest = trimesh.triangles.closest_point(SHAPE.positions[SHAPE.triangles[which]], points)
    assert np.abs(nearest - points).max() < 1e-9


@pytest.mark.parametrize(
    ("size", "unit", "says"),
    [
        (100.0 / 25.4, "mm", "--units in"),
        (100_000.0, "mm", "--units um"),
        (2540.0, "in", "millimetres; use --units mm"),
        (80.0 / 25.4, "mm", "in inches or centimetres; use --units in or --units cm"),
        (1e7, "mm", "right scan"),
    ],
)
def test_units_are_recognised(size: float, unit: str, says: str) -> None:
    with pytest.raises(ScanError, match=says):
        check_size(Path("a.obj"), size, 100.0, unit)


def test_parts_and_surroundings_pass() -> None:
    for size in (30.0, 190.0):
        check_size(Path("a.obj"), size, 100.0, "mm")


GRID = np.array([(9.0 * x, 9.0 * y, 0.1 * x * y) for x in range(5) for y in range(5)])
FACES = np.array([(5 * x + y, 5 * x + y + 5, 5 * x + y + 6) for x in range(4) for y in range(4)])


def obj_text(begin: str = "", face: str = "f {} {} {}", end: str = "\n") -> bytes:
    lines = [begin, *("v {} {} {}".format(*place) for place in GRID), *(face.format(*f) for f in FACES + 1)]
    return end.join([*lines, ""]).encode("latin-1")


def ply_text(end: str = "\n", blank: str = " ", comment: str = "comment Gr\xf6\xdfe") -> bytes:
    head = ["ply", "format ascii 1.0", comment, f"element vertex {len(GRID)}", "property float x", "property float y"]
    head += ["property float z", f"element face {len(FACES)}", "property list uchar int vertex_indices", "end_header"]
    lines = [*head, *("{} {} {}".format(*p) for p in GRID), *("3 {} {} {}".format(*f) for f in FACES)]
    return end.join([line.replace(" ", blank) for line in lines] + [""]).encode("latin-1")


def ply_binary(end: bytes = b"\n", order: str = "<") -> bytes:
    name = {"<": b"binary_little_endian", ">": b"binary_big_endian"}[order]
    head = ply_text().replace(b"ascii", name).partition(b"end_header\n")[0] + b"end_header\n"
    faces = b"".join(struct.pack(f"{order}B3i", 3, *face) for face in FACES.tolist())
    return head.replace(b"\n", end) + GRID.astype(f"{order}f4").tobytes() + faces


def stl_binary(name: bytes = b"") -> bytes:
    facets = b"".join(struct.pack("<12fH", 0, 0, 1, *GRID[face].ravel(), 0) for face in FACES)
    return name.ljust(80, b" ") + struct.pack("<I", len(FACES)) + facets


def stl_text(name: str = "a") -> bytes:
    loops = ["".join("vertex {} {} {}\n".format(*place) for place in GRID[face]) for face in FACES]
    facets = "".join(f"facet normal 0 0 1\nouter loop\n{loop}endloop\nendfacet\n" for loop in loops)
    return f"solid {name}\n{facets}endsolid {name}\n".encode("latin-1")


SVG = '<svg xmlns="http://www.w3.org/2000/svg" {size}>{body}</svg>'
RECT = '<rect x="10" y="10" width="50" height="20"/>'
OBJ, PLY = obj_text(), ply_text()
VERTICES = OBJ.partition(b"f ")[0].lstrip()
LOOP = b"solid a\nfacet normal 0 0 1\nouter loop\n%bendloop\nendfacet\nendsolid a"


@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("a.obj", b"", "holds no points"),
        ("a.stl", b"", "0 bytes"),
        ("a.ply", b"", "cannot be read as PLY"),
        ("a.obj", b"\x00\xff\xfe\x12", "cannot be read as OBJ"),
        ("a.obj", b"v 1 2 3\n" * 40, "too few points"),
        ("a.obj", "".join(f"v {k} {2 * k} 1e-6\n" for k in range(40)).encode(), "on one line"),
        ("a.obj", b"v 1 2 nan\nv 0 0 1\n", "finite"),
        # three short lines of two numbers make two vertices for a parser that only counts numbers
        *(("a.obj", VERTICES + n * line, "line 26") for line in (b"v 1 2\n", b"v\n", b"v 1 2 x\n") for n in (1, 3)),
        ("a.obj", OBJ + b"f 0 1 2", "line 43: the face has the vertex 0, but vertices are numbered from 1 to 25"),
        ("a.obj", OBJ + b"f 1 -26 2", "line 43: the face has the vertex -26"),
        ("a.obj", OBJ + b"f 1 x 2", "line 43: 'x' is no number of a vertex"),
        ("a.obj", OBJ + b"f 1 2", "line 43: a face needs 3 corners, not 2"),
        ("a.obj", obj_text(face="f {} \\\n {} {}") + b"f 1 2 x", "line 59: 'x' is no number of a vertex"),
        ("a.ply", PLY.replace(b"\n3 0 5 6", b"\n3 0 5"), "face 1: has 3 numbers, the file announces 4"),
        ("a.ply", PLY.replace(b"\n3 0 5 6", b"\n3 0 5 99"), "corners that it does not hold"),
        ("a.ply", PLY.replace(b"float y", b"flooat y"), "'flooat'; there are char, uchar"),
        ("a.ply", ply_binary()[:-90], "cannot be read as PLY: the file is damaged or cut short"),
        ("a.ply", b"\n".join(PLY.split(b"\n")[:17]), "7 of 41 lines"),
        ("a.ply", PLY.replace(b"36.0 36.0 1.6", b"36.0 36.0"), "vertex 25"),
        ("a.stl", LOOP % b"vertex 0 0 0\nvertex 1 0 x\nvertex 0 1 0\n", "line 5: 'x' is not a number"),
        ("a.stl", LOOP % b"vertex 0 0 0\nvertex 1 0 0\n", "line 6: a triangle needs 3"),
        ("a.stl", stl_binary()[:500], "8 of 16 triangles"),
        ("a.svg", SVG.format(size='width="10cm" height="10cm"', body=RECT).encode(), "its own size: --units"),
        ("a.svg", SVG.format(size="", body="").encode(), "no line"),
        ("a.svg", b"<html></html>", "is not a drawing in SVG"),
        ("a.csv", b"x_mm,y_mm\n0,0\n10,10\n10,0\n0,10\n", "crosses itself"),
        ("a.csv", b"x_mm,y_mm\n0,0\n10,10\n", "at least three"),
        ("a.csv", b"x_mm,y_mm\n1," + b"9" * 140_000, "row 2: field larger"),
        ("a.csv", b"x_mm,y_mm\n1,nan\n", "row 2, column y_mm: nan is not a finite number"),
    ],
)
def test_mistakes_and_damages_are_named_with_their_place(
    name: str, content: bytes, expected: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(content)
    read = read_outline if name.endswith((".svg", ".csv")) else read_scan
    with pytest.raises((ScanError, TableError), match=re.escape(expected)) as caught:
        read(tmp_path / name, "cm")
    assert name in str(caught.value) and "\n" not in str(caught.value)


def test_parts_and_polygons_count_and_textures_and_colours_are_passed_over(tmp_path: Path) -> None:
    corners = "v 0 0 0\nv 50 0 0\nv 50 50 0\nv 0 50 0\nv 0 0 9\nv 50 0 9\nv 50 50 9\n"
    (tmp_path / "parts.obj").write_text(corners + "o one\nf 1 2 3 4\no two\nf 5 6 7\n")
    assert read_scan(tmp_path / "parts.obj").triangles == 3
    (tmp_path / "a.obj").write_bytes(OBJ + b"f 4/1/1 5//2 -1")
    (tmp_path / "b.obj").write_bytes(VERTICES.replace(b"\n", b" 0.5 0.5 0.5\n"))
    scans = [read_scan(tmp_path / name) for name in ("a.obj", "b.obj")]
    assert [(scan.vertices, scan.triangles) for scan in scans] == [(25, 17), (25, 0)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("comment.obj", obj_text("# Gr\xf6\xdfe")),
        ("group.obj", obj_text("mtllib Gr\xfcn.mtl\no Fl\xe4che\nusemtl Gr\xfcn")),
        ("wrapped-in-windows.obj", obj_text(face="f {} {} \\\r\n{}", end="\r\n")),
        ("old-mac.obj", obj_text(end="\r")),
        ("mark.obj", b"\xef\xbb\xbf" + obj_text().lstrip()),
        ("comment.ply", ply_text()),
        ("windows.ply", ply_text(end="\r\n")),
        ("picture.ply", ply_text(comment="comment TextureFile none.png")),
        ("trailing.ply", ply_text() + b"1 2 3\n\x1a"),
        ("binary.ply", ply_binary()),
        ("binary-trailing.ply", ply_binary() + bytes(70)),
        ("binary-big.ply", ply_binary(order=">") + bytes(3)),
        ("binary.stl", stl_binary()),
        ("called-solid.stl", stl_binary(b"solid part")),
        ("trailing.stl", stl_binary() + bytes(70)),
        ("text.stl", stl_text("Fl\xe4che")),
        ("text-trailing.stl", stl_text() + bytes(70)),
        ("tabs.stl", stl_text().replace(b" ", b"\t")),
    ],
)
def test_files_that_programs_write_are_read(name: str, content: bytes, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    vertices, triangles = read_surface(tmp_path / name)
    assert np.allclose(vertices[triangles], GRID[FACES], atol=1e-5)


def test_polygons_of_a_binary_ply_may_differ(tmp_path: Path) -> None:
    head = ply_binary().partition(b"end_header\n")[0].replace(b"face 32", b"face 16")
    head = head.replace(b"property list", b"property uchar red\nproperty list") + b"end_header\n"
    faces = [[0, 5, 6, 1], [1, 6, 7], [2, 7, 8, 9, 4]] + [[10, 15, 16]] * (len(FACES) - 3)
    packed = b"".join(struct.pack(f"<BB{len(face)}i", 9, len(face), *face) for face in faces)
    (tmp_path / "a.ply").write_bytes(head + GRID.astype("<f4").tobytes() + packed)
    _, triangles = read_surface(tmp_path / "a.ply")
    assert sorted(triangles.tolist())[:3] == [[0, 5, 6], [1, 6, 7], [2, 7, 8]] and len(triangles) == 6 + len(FACES) - 3


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b"property float x", b"property list uchar float x"),
        (b"property float y", b"property float x"),
        (b"\n3 0 5 6", b"\nnan 0 5 6"),
        (b"\n3 0 5 6", b"\n3 0 5 99"),
        (b"element vertex 25", b"element vertex 99999999999"),
        (b"ascii", b"text"),
    ],
)
@pytest.mark.parametrize("content", [ply_text(), ply_binary()], ids=["text", "binary"])
def test_odd_headers_and_lists_of_a_ply_end_in_one_line(content: bytes, old: bytes, new: bytes, tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(content.replace(old, new, 1))
    if old in content:
        with pytest.raises(ScanError, match=r"a\.ply: "):
            read_surface(tmp_path / "a.ply")


@pytest.mark.parametrize(
    ("size", "scale"),
    [
        ('width="100mm" height="100mm" viewBox="0 0 100 100"', 1.0),
        ('width="100mm" height="80mm"', 25.4 / 96),  # without a viewBox a unit is a pixel, whatever the size
        ('viewBox="0 0 100 100"', 1.0),
    ],
)
def test_svg_in_mm(size: str, scale: float, tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text(SVG.format(size=size, body=RECT + '<circle cx="2" cy="2" r="1"/>'))
    outline = read_outline(tmp_path / "a.svg")
    corners = outline.corners
    # y upwards, and the larger one of both
    assert outline.lines == 2 and (outline.unit is None) == ("width" in size)
    np.testing.assert_allclose(corners.min(axis=0), [10 * scale, -30 * scale], rtol=1e-5)
    np.testing.assert_allclose(corners.max(axis=0), [60 * scale, -10 * scale], rtol=1e-5)


def test_csv(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x_mm;y_mm\n0;0\n10;0\n10;10\n0;0\n")
    np.testing.assert_array_equal(read_outline(tmp_path / "a.csv", "cm").corners, [[0, 0], [100, 0], [100, 100]])


def test_silhouettes() -> None:
    plate = sheet(flat, 100, 80, 5.0)
    assert shapely.Polygon(silhouette(plate, "above")).area == pytest.approx(8000, rel=1e-3)
    # a spiral that is seen from its end is a line, drawn around on both sides
    rolled = shapely.Polygon(silhouette(sheet(tube, 100, 80, 3.0), "side"))
    assert rolled.length == pytest.approx(2 * 80, rel=0.05)
    low = silhouette(sheet(dome, 100, 80, 3.0), "front")
    assert np.ptp(low[:, 0]) > 2 * np.ptp(low[:, 1])


@pytest.mark.slow
def test_known_motions_are_undone_and_mirrored_outlines_stay_mirrored() -> None:
    turn = 2.0
    corners = np.array([[0, 0], [90, 0], [90, 40], [40, 60], [0, 40]], dtype=float)
    cos, sin = np.cos(turn), np.sin(turn)
    found = fit_outline(corners @ np.array([[cos, sin], [-sin, cos]]) + [300, -20], corners)
    np.testing.assert_allclose(found.outline, corners, atol=0.05)
    assert np.abs(found.distance).max() < 0.05 and found.missed.max() < 0.05
    corners[-1] = [0, 20]
    assert np.abs(fit_outline(corners * [-1, 1], corners).distance).max() > 3


@pytest.mark.slow
def test_a_larger_outline_is_outside() -> None:
    corners = np.array([[0, 0], [90, 0], [90, 40], [0, 40]], dtype=float)
    larger = shapely.get_coordinates(shapely.buffer(shapely.Polygon(corners), 2.0, join_style="mitre"))[:-1]
    assert fit_outline(larger, corners).distance.mean() == pytest.approx(2.0, abs=0.1)
    assert fit_outline(corners, larger).distance.mean() == pytest.approx(-2.0, abs=0.1)
