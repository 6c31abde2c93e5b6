"""STL and 3MF read back by other libraries: closed, in millimetres, where they belong on the bed."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest
import trimesh

from asterism.print.formats.stl import write_stl
from asterism.print.formats.threemf import write_3mf
from tests.asterism.print.jobs import design, job


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
    write_3mf(tmp_path / "a.3mf", one.solids, one.design.name, one.rounding)
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


def test_3mf_says_millimetres_and_has_no_transforms(tmp_path: Path) -> None:
    """Several slicers take the unit for the vertices and not for transforms."""
    write_3mf(tmp_path / "a.3mf", job().solids, "small")
    write_3mf(tmp_path / "b.3mf", job().solids, "small")
    assert (tmp_path / "a.3mf").read_bytes() == (tmp_path / "b.3mf").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.3mf") as package:
        assert package.namelist()[0] == "[Content_Types].xml"
        model = package.read("3D/3dmodel.model").decode()
    assert 'unit="millimeter"' in model and "transform" not in model and "component" not in model
