"""Files of prints and of shapes, read by libraries that did not write them; scripts make the solids of the STL."""

from __future__ import annotations

import ast
import re
import sys
import zipfile
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rhino3dm
import shapely
import trimesh

import asterism
from asterism import Design, Shape
from asterism.pattern import gallery
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import layout
from asterism.print.formats.meshes import write_shape_obj, write_stl
from asterism.print.formats.registry import demanded_formats, write_all
from asterism.print.formats.rhino import write_rhino
from asterism.print.formats.scripts import write_icesl, write_openscad
from asterism.print.formats.threemf import write_3mf
from asterism.print.job import Job
from asterism.print.solid import Piece
from asterism.shape.vtu import write_shape_vtu
from tests.asterism.print.jobs import LEAF, design, job
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


TAPER = {"profile": "radial", "from": 0.6, "to": 0.3, "over_mm": 30.0}


@pytest.fixture(scope="module")
def tapered() -> Job:
    stars = {"length_mm": 8.0, "thickness_mm": TAPER, "vary_along_arms": True}
    return job(design(fabric={}, stars=stars), turn_deg=20.0)


@pytest.fixture(scope="module", params=["stars", "rods"])
def one(request: pytest.FixtureRequest) -> Job:
    """Stars in layers, or drawn lines."""
    if request.param == "stars":
        return request.getfixturevalue("tapered")
    return job(Design.from_dict(LEAF), turn_deg=30.0)


def volume(prisms: list[tuple[float, shapely.Polygon]]) -> float:
    """Volume of the union of prisms that stand on the ground."""
    heights = sorted({height for height, _ in prisms})
    return sum(
        shapely.union_all([region for h, region in prisms if h >= height]).area * (height - below)
        for height, below in zip(heights, [0.0, *heights], strict=False)
    )


def check(prisms: list[tuple[float, shapely.Polygon]], one: Job) -> None:
    """They are as large as the solid, and where it is."""
    solid, accuracy = one.solids[0], 3e-4 if one.arms else 2e-3
    assert volume(prisms) == pytest.approx(solid.volume_mm3, rel=accuracy)
    box = shapely.union_all([region for _, region in prisms]).bounds
    assert box == pytest.approx([*solid.box[0, :2], *solid.box[1, :2]], abs=0.005)


def test_lua_runs_and_makes_the_plastic(one: Job, tmp_path: Path) -> None:
    lupa = pytest.importorskip("lupa")
    write_icesl(tmp_path / "a.lua", one)
    lua = lupa.LuaRuntime()
    emitted: list[Any] = []

    # what IceSL adds to Lua, as far as the script uses it
    def linear_extrude(along: tuple[float, float, float], outline: Any) -> list[Any]:
        assert along[:2] == (0, 0)
        points = [outline[k] for k in range(1, len(outline) + 1)]
        assert all(z == 0 for *_, z in points)
        ring = shapely.LinearRing([point[:2] for point in points])
        assert ring.is_ccw and ring.is_simple
        return [(round(along[2], 6), shapely.Polygon(ring))]

    lua.globals().v = lambda x, y, z: (x, y, z)
    lua.globals().linear_extrude = linear_extrude
    lua.globals().union = lambda one, other: one + other
    lua.globals().emit = emitted.append
    lua.execute((tmp_path / "a.lua").read_text())
    assert len(emitted) == (len(one.plan.centres) or len(one.plan.graph.rods))
    check([prism for part in emitted for prism in part], one)


def test_the_table_of_openscad_holds_the_plastic(one: Job, tmp_path: Path) -> None:
    write_openscad(tmp_path / "a.scad", one)
    text = (tmp_path / "a.scad").read_text()
    assert one.arms or "star" not in text
    table = ast.literal_eval(re.search(r"parts = (\[.*?\n\]);", text, re.DOTALL)[1])  # type: ignore[index]
    if one.arms:  # one star is moved by the numbers of its centre
        centres = one.placement.points(one.plan.centres) + one.printer.bed_centre_mm
        assert np.array([part[:2] for part in table]) == pytest.approx(centres, abs=1e-6)
    prisms = []
    for x, y, part in table:
        for height, begin, end, corners in part:
            points = np.array(corners) + np.array([x, y, 0.0])
            prisms.append((height, Piece(0, points[:, :2], points[:, 2], height, (begin == 1, end == 1)).region))
    check(prisms, one)


def test_a_name_stays_within_its_comment(tmp_path: Path) -> None:
    one = job(design(name="ring ]] } ' \" -- //"))
    write_icesl(tmp_path / "a.lua", one)
    write_openscad(tmp_path / "a.scad", one)
    for file, sign in (("a.lua", "--"), ("a.scad", "//")):
        first, second, *_ = (tmp_path / file).read_text().splitlines()
        assert first.startswith(f"{sign} ring ]] }} ' \" -- //: stars") and second.startswith(sign)


def raised_dome() -> Design:
    """Seven stars on needles, one of them raised."""
    data = gallery.load("dome").to_dict()
    data["pins"] = [*data["pins"], {"points_mm": [[0.0, 0.0]], "target_mm": [[0.0, 0.0, 9.0]]}]
    return Design.from_dict(data | {"border": {"rings": 1}, "stars": {"length_mm": 8.0, "thickness_mm": 0.3}})


@pytest.fixture(scope="module")
def in_rhino(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path]:
    """The export of a small dome with its preview, and its folder."""
    folder = tmp_path_factory.mktemp("rhino")
    return asterism.export(raised_dome(), folder, asterism.ExportSettings(preview=True, formats=("3dm",))), folder


def by_layer(path: Path) -> dict[str, list[Any]]:
    file = rhino3dm.File3dm.Read(str(path))
    assert file.Settings.ModelUnitSystem == rhino3dm.UnitSystem.Millimeters
    found = defaultdict(list)
    for thing in file.Objects:
        found[file.Layers.FindIndex(thing.Attributes.LayerIndex).FullPath].append(thing)
    return found


def points(curve: Any) -> np.ndarray:
    places = [curve.Point(number) for number in range(curve.PointCount)]
    return np.array([(place.X, place.Y, place.Z) for place in places])


@pytest.mark.slow
def test_layers_hold_the_print_the_sheet_and_the_base(in_rhino: tuple[Any, Path]) -> None:
    exported, folder = in_rhino
    found, job_ = by_layer(folder / "model.3dm"), exported.job
    layers = ["base::drilling", "print::needles", "print::outline", "print::plastic"]
    assert sorted(found) == [*layers, "space::arms", "space::needles", "space::outline", "space::sheet"]
    assert "model.3dm" in exported.files
    # as on the layout
    (outline,) = (points(thing.Geometry) for thing in found["print::outline"])
    assert np.allclose(outline[:-1, :2], job_.placement.points(job_.plan.outline)) and not outline[:, 2].any()
    assert np.array_equal(outline[0], outline[-1])
    area = sum(abs(polygon_area(points(thing.Geometry)[:-1, :2])) for thing in found["print::plastic"])
    assert area == pytest.approx(job_.pattern[0].region.area, rel=1e-9)
    for thing, needle in zip(found["print::needles"], job_.needles, strict=True):
        place = thing.Geometry.Location
        assert thing.Attributes.Name == f"needle {needle.number}"
        assert np.allclose([place.X, place.Y], job_.placement.points(needle.printed))
    # the base is drilled where the needles stand
    drilling = found["base::drilling"]
    circles = [thing.Geometry for thing in drilling if not isinstance(thing.Geometry, rhino3dm.Point)]
    assert len(drilling) == 2 * len(job_.needles)
    for circle, needle in zip(circles, job_.needles, strict=True):
        box = circle.GetBoundingBox()
        assert np.allclose([box.Center.X, box.Center.Y], needle.place[:2], atol=1e-6)
        assert pytest.approx(1.0, rel=1e-6) == box.Max.X - box.Min.X


@pytest.mark.slow
def test_the_sheet_in_space_is_the_shape_on_its_needles(in_rhino: tuple[Any, Path]) -> None:
    exported, folder = in_rhino
    found, shape = by_layer(folder / "model.3dm"), exported.job.shape
    (sheet,) = (thing.Geometry for thing in found["space::sheet"])
    vertices = np.array([(place.X, place.Y, place.Z) for place in sheet.Vertices])
    faces = np.array([sheet.Faces[number] for number in range(len(sheet.Faces))])
    assert np.allclose(vertices, shape.positions, atol=1e-4)  # the file has single precision
    assert np.array_equal(faces[:, :3], shape.triangles) and np.array_equal(faces[:, 2], faces[:, 3])
    assert len(found["space::arms"]) == len(shape.rods) == 3 * 7
    assert np.allclose(points(found["space::arms"][0].Geometry), shape.positions[shape.rods[0]])
    (outline,) = (points(thing.Geometry) for thing in found["space::outline"])
    corners = shape.at(exported.job.plan.outline)
    assert all(np.linalg.norm(outline - corner, axis=1).min() < 1e-9 for corner in corners)
    # from the base to the sheet
    (line,) = found["space::needles"]
    (raised,) = (needle for needle in exported.job.needles if needle.is_raised)
    foot, upper = (np.array([p.X, p.Y, p.Z]) for p in (line.Geometry.PointAtStart, line.Geometry.PointAtEnd))
    assert line.Attributes.Name == f"needle {raised.number}"
    assert upper[2] - foot[2] == pytest.approx(9.0)
    assert np.allclose(upper, shape.at(raised.printed[None])[0])


def test_without_a_shape_all_of_rhinos_file_lies_in_a_plane(tmp_path: Path) -> None:
    write_rhino(tmp_path / "model.3dm", job())
    found = by_layer(tmp_path / "model.3dm")
    assert sorted(found) == ["base::drilling", "print::needles", "print::outline", "print::plastic"]
    assert all(thing.Geometry.GetBoundingBox().Max.Z == 0.0 for things in found.values() for thing in things)


def test_other_names_and_a_missing_package_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"--format = 'stp': must be 3dm; all other formats are always written"):
        asterism.export(raised_dome(), tmp_path / "out", asterism.ExportSettings(formats=("stp",)))
    monkeypatch.setitem(sys.modules, "rhino3dm", None)
    with pytest.raises(
        DesignError, match=r'''--format = '3dm': needs rhino3dm: pip install "asterism-fabric\[cad\]"'''
    ):
        demanded_formats(["3DM"])
    assert not (tmp_path / "out").exists()
