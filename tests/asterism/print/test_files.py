"""Files of prints and of shapes, read back by libraries that did not write them, in their own units."""

from __future__ import annotations

import json
import struct
import zipfile
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
import trimesh

from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.print.formats.obj import write_shape_obj
from asterism.print.formats.registry import write_all
from asterism.print.formats.stl import write_stl
from asterism.print.formats.threemf import write_3mf
from asterism.shape.shape import Shape
from asterism.shape.vtu import write_shape_vtu
from tests.asterism.print.jobs import design, job
from tests.asterism.sheets import sheet


def test_stl_is_watertight_and_in_place(tmp_path: Path) -> None:
    one = job()
    for solid in one.solids:
        write_stl(tmp_path / "a.stl", solid.points, solid.triangles)
        mesh = trimesh.load_mesh(tmp_path / "a.stl")
        assert mesh.is_watertight and mesh.is_winding_consistent
        assert mesh.volume == pytest.approx(solid.volume_mm3, rel=1e-5)
        assert np.abs(mesh.bounds - solid.box).max() < 0.001
    # the middle of the design is over the middle of the bed
    low, high = one.solids[1].box[:, :2]
    assert (low + high) / 2 == pytest.approx([111.5, 111.5], abs=0.001)


def test_3mf_passes_the_strict_reader_of_its_makers(tmp_path: Path) -> None:
    lib3mf = pytest.importorskip("lib3mf")
    one = job(design(name='<small> & "ä" 名'))
    for name in ("a.3mf", "b.3mf"):
        write_3mf(tmp_path / name, one.solids, one.design.name, one.rounding)
    assert (tmp_path / "a.3mf").read_bytes() == (tmp_path / "b.3mf").read_bytes()
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.SetStrictModeActive(True)
    reader.ReadFromFile(str(tmp_path / "a.3mf"))
    assert reader.GetWarningCount() == 0
    assert model.GetUnit() == lib3mf.ModelUnit.MilliMeter
    titles = model.GetMetaDataGroup()
    assert {titles.GetMetaData(k).GetValue() for k in range(titles.GetMetaDataCount())} >= {one.design.name}
    items, found = model.GetBuildItems(), {}
    while items.MoveNext():
        item = items.GetCurrent()
        assert not item.HasObjectTransform()
        thing = item.GetObjectResource()
        assert thing.IsMeshObject() and thing.IsManifoldAndOriented()
        found[thing.GetName()] = model.GetMeshObjectByID(thing.GetResourceID())
    assert list(found) == ["stars", "border"]
    for solid in one.solids:
        points = np.array([list(vertex.Coordinates) for vertex in found[solid.name].GetVertices()])
        triangles = np.array([list(triangle.Indices) for triangle in found[solid.name].GetTriangleIndices()])
        mesh = trimesh.Trimesh(points, triangles, process=False)
        assert mesh.is_watertight
        assert mesh.volume == pytest.approx(solid.volume_mm3, rel=1e-4)
        assert np.abs(mesh.bounds - solid.box).max() < 0.001
    # several slicers take the unit for the vertices and not for transforms
    with zipfile.ZipFile(tmp_path / "a.3mf") as package:
        assert package.namelist()[0] == "[Content_Types].xml"
        text = package.read("3D/3dmodel.model").decode()
    assert "transform" not in text and "component" not in text


@pytest.fixture(scope="module")
def dome() -> Shape:
    """A cap, longer than wide, that bulges to the plastic's side."""
    return sheet(lambda p: np.column_stack([0.7 * p, 20.0 - (p**2).sum(axis=1) / 200.0]), 80.0, 60.0, 4.0)


@pytest.fixture(scope="module")
def folder(dome: Shape, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("shape")
    write_all("shape", path, "shape", dome, 'do"me')
    write_shape_vtu(dome, path / "shape.vtu")
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


def test_obj_has_sheet_stars_and_needles_as_groups(dome: Shape, folder: Path, tmp_path: Path) -> None:
    """Read line by line: libraries drop lines and names of groups."""
    pins = [{"points_mm": [[-38.0, 0.0], [38.0, 0.0]]}, {"edges": [0]}]
    sections = {"stars": {"length_mm": 8.0}, "border": {"rectangle_mm": [80.0, 60.0]}, "pins": pins}
    held = replace(dome, plan=layout(Design.from_dict(sections)))
    write_shape_obj(tmp_path / "held.obj", held, "two\nlines")
    groups: dict[str, list[list[int]]] = {}
    vertices, group = [], ""
    for line in (tmp_path / "held.obj").read_text().splitlines():
        word, *rest = line.split()
        if word == "g":
            groups[group := rest[0]] = []
        elif word == "v":
            vertices.append([float(number) for number in rest])
        elif word != "#":
            groups[group].append([int(number) - 1 for number in rest])
    places = np.array(vertices)
    assert list(groups) == ["sheet", "stars", "needles"]
    assert np.array_equal(groups["sheet"], held.triangles)
    assert all(np.array_equal(mine, rod) for mine, rod in zip(groups["stars"], held.rods, strict=True))
    needles = places[np.array(groups["needles"])]
    # two points, and 80 mm of an edge with a needle every 20 mm
    assert needles.shape == (2 + 5, 2, 3)
    assert needles[0, 0] == pytest.approx([-26.6, 0.0, 20.0 - 38.0**2 / 200.0], abs=0.05)
    assert np.ptp(needles[:, :, :2], axis=1) == pytest.approx(0.0)
    assert needles[:, 1, 2] == pytest.approx(held.positions[:, 2].min() - 5.0, abs=1e-5)
    # trimesh still reads the sheet, and a free sheet has no needles
    assert len(trimesh.load_mesh(tmp_path / "held.obj").faces) == len(held.triangles)
    assert "needles" not in (folder / "shape.obj").read_text()


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
