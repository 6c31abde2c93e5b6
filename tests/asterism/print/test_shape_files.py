"""The shape as OBJ, STL, GLB and VTU, read back by another library in its own units."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh

from asterism.print.write import write_shape_files
from asterism.shape.shape import Shape
from tests.asterism.sheets import sheet


@pytest.fixture(scope="module")
def dome() -> Shape:
    """A cap, longer than wide, that bulges to the plastic's side."""
    return sheet(lambda p: np.column_stack([0.7 * p, 20.0 - (p**2).sum(axis=1) / 200.0]), 80.0, 60.0, 4.0)


@pytest.fixture(scope="module")
def folder(dome: Shape, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("shape")
    write_shape_files(dome, 'do"me', path)
    return path


@pytest.mark.parametrize("name", ["shape.obj", "shape.stl"])
def test_millimetres(dome: Shape, folder: Path, name: str) -> None:
    mesh = trimesh.load_mesh(folder / name)
    assert len(mesh.faces) == len(dome.triangles)
    assert mesh.bounds == pytest.approx(np.array([dome.positions.min(axis=0), dome.positions.max(axis=0)]), abs=1e-4)
    # the plastic's side is the front
    assert (mesh.face_normals[:, 2] > 0).all()
    same = trimesh.Trimesh(dome.positions, dome.triangles, process=False)
    assert mesh.area == pytest.approx(same.area, rel=1e-6)


def test_glb_is_in_metres_with_y_upwards(dome: Shape, folder: Path) -> None:
    scene = trimesh.load_scene(folder / "shape.glb")
    (mesh,) = scene.dump()
    low, high = dome.positions.min(axis=0) / 1000, dome.positions.max(axis=0) / 1000
    assert mesh.bounds == pytest.approx(np.array([[low[0], low[2], -high[1]], [high[0], high[2], -low[1]]]), abs=1e-7)
    assert (mesh.face_normals[:, 1] > 0).all()
    assert mesh.vertex_normals[:, 1].min() > 0
    assert mesh.visual.material.doubleSided


def test_glb_is_aligned_as_the_specification_demands(folder: Path) -> None:
    data = (folder / "shape.glb").read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON" and size % 4 == 0
    scene = json.loads(data[20 : 20 + size])
    binary, kind = struct.unpack_from("<I4s", data, 20 + size)
    assert kind == b"BIN\0" and binary % 4 == 0 and scene["buffers"][0]["byteLength"] == binary
    assert 28 + size + binary == len(data)
    assert all(view["byteOffset"] % 4 == 0 for view in scene["bufferViews"])
    assert scene["nodes"][0]["name"] == 'do"me'


def test_vtu(dome: Shape, folder: Path) -> None:
    mesh = meshio.read(folder / "shape.vtu")
    assert np.array_equal(mesh.points, dome.positions)
    assert np.array_equal(mesh.point_data["printed_mm"][:, :2], dome.printed)
