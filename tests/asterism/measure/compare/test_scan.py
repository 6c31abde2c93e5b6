"""Files of scans: what is read, and one line for everything else."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from asterism.measure.compare.scan import ScanError, check_size, extents, read_scan, read_surface, surface_samples
from tests.asterism.measure.compare.scans import bent_sheet

SHAPE = bent_sheet(5.0)
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
50 0 0
0 50 0
3 0 1 2
3 0 1 {corner}
"""
MESH = trimesh.Trimesh(SHAPE.positions, SHAPE.triangles, process=False)


@pytest.mark.parametrize("name", ["a.obj", "a.stl", "a.ply", "A.OBJ"])
def test_meshes(name: str, tmp_path: Path) -> None:
    MESH.export(tmp_path / name, file_type=name[-3:].lower())
    scan = read_scan(tmp_path / name)
    assert scan.triangles == len(SHAPE.triangles)
    assert extents(scan.points) == pytest.approx(extents(SHAPE.positions), rel=0.05)
    assert len(scan.points) == 20_000


@pytest.mark.parametrize("name", ["a.obj", "a.stl", "a.ply"])
def test_surfaces(name: str, tmp_path: Path) -> None:
    MESH.export(tmp_path / name)
    vertices, triangles = read_surface(tmp_path / name)
    assert vertices[triangles] == pytest.approx(SHAPE.positions[SHAPE.triangles], abs=1e-5)


def test_clouds_are_no_surfaces(tmp_path: Path) -> None:
    trimesh.PointCloud(SHAPE.positions).export(tmp_path / "a.ply")
    with pytest.raises(ScanError, match="points without triangles"):
        read_surface(tmp_path / "a.ply")
    with pytest.raises(ScanError, match="must end in"):
        read_surface(tmp_path / "a.svg")


@pytest.mark.parametrize("name", ["a.obj", "a.ply"])
def test_clouds(name: str, tmp_path: Path) -> None:
    if name.endswith("obj"):
        (tmp_path / name).write_text("".join(f"v {x} {y} {z}\n" for x, y, z in SHAPE.positions))
    else:
        trimesh.PointCloud(SHAPE.positions).export(tmp_path / name)
    scan = read_scan(tmp_path / name, "cm")
    assert scan.triangles == 0 and len(scan.points) == len(SHAPE.positions)
    np.testing.assert_allclose(
        np.sort(scan.points, axis=0), 10 * np.sort(SHAPE.positions, axis=0), rtol=1e-6, atol=1e-4
    )


def test_several_parts_and_polygons(tmp_path: Path) -> None:
    corners = "v 0 0 0\nv 50 0 0\nv 50 50 0\nv 0 50 0\nv 0 0 9\nv 50 0 9\nv 50 50 9\n"
    (tmp_path / "a.obj").write_text(corners + "o one\nf 1 2 3 4\no two\nf 5 6 7\n")
    assert read_scan(tmp_path / "a.obj").triangles == 3


def test_samples_are_spread_by_area() -> None:
    points, which = surface_samples(SHAPE.positions, SHAPE.triangles, 50_000, np.random.default_rng(0))
    share = np.bincount(which, minlength=len(SHAPE.triangles)) / len(points)
    np.testing.assert_allclose(share, MESH.area_faces / MESH.area, atol=4.1e-5)
    assert (
        np.abs(trimesh.triangles.closest_point(SHAPE.positions[SHAPE.triangles[which]], points) - points).max() < 1e-9
    )


@pytest.mark.parametrize(
    ("name", "content", "problem"),
    [
        ("a.obj", b"", "holds no points"),
        ("a.obj", b"# nothing\n", "holds no points"),
        ("a.stl", b"", "0 bytes"),
        ("a.stl", b"solid a\nendsolid a\n", "holds no points"),
        ("a.ply", b"", "cannot be read as PLY"),
        ("a.obj", b"\x00\xff\xfe\x12", "cannot be read as OBJ"),
        ("a.obj", b"v 1 2 3\n" * 40, "too few points"),
        ("a.obj", "".join(f"v {k} {2 * k} 1e-6\n" for k in range(40)).encode(), "on one line"),
        ("a.obj", b"v 1 2 nan\nv 0 0 1\n", "finite"),
        ("a.jpg", b"", "must end in"),
        ("a.ply", PLY.format(corner=5).encode(), "corners that it does not hold"),
        ("a.ply", PLY.format(corner=-1).encode(), "corners that it does not hold"),
    ],
)
def test_mistakes(name: str, content: bytes, problem: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ScanError, match=problem) as caught:
        read_scan(tmp_path / name)
    assert name in str(caught.value) and "\n" not in str(caught.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(ScanError, match="not there"):
        read_scan(tmp_path / "a.obj")


@pytest.mark.parametrize(
    ("size", "unit", "says"),
    [
        (100.0 / 25.4, "mm", "--units in"),
        (0.1, "mm", "metres; use --units m"),
        (10.0, "mm", "--units cm"),
        (100_000.0, "mm", "--units um"),
        (2540.0, "in", "millimetres; use --units mm"),
        (80.0 / 25.4, "mm", "in inches or centimetres; use --units in or --units cm"),
        (1e7, "mm", "right scan"),
    ],
)
def test_units_are_recognised(size: float, unit: str, says: str) -> None:
    with pytest.raises(ScanError, match=says):
        check_size(Path("a.obj"), size, 100.0, unit)


@pytest.mark.parametrize("size", [30.0, 100.0, 190.0])
def test_parts_and_surroundings_pass(size: float) -> None:
    check_size(Path("a.obj"), size, 100.0, "mm")
