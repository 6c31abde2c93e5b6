"""The 3DM file of an export, read back."""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import asterism
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import polygon_area
from asterism.print.formats.registry import demanded_formats
from asterism.print.formats.rhino import write_rhino
from tests.asterism.print.jobs import job

rhino3dm: Any = pytest.importorskip("rhino3dm")


def dome() -> Design:
    """Seven stars on needles, one of them raised."""
    data = gallery.load("dome").to_dict()
    data["pins"] = [*data["pins"], {"points_mm": [[0.0, 0.0]], "target_mm": [[0.0, 0.0, 9.0]]}]
    return Design.from_dict(data | {"border": {"rings": 1}, "stars": {"length_mm": 8.0, "thickness_mm": 0.3}})


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> tuple[Any, Path]:
    """The export of a small dome with its preview, and its folder."""
    folder = tmp_path_factory.mktemp("rhino")
    return asterism.export(dome(), folder, asterism.ExportSettings(preview=True, formats=("3dm",))), folder


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
def test_layers_hold_the_print_the_sheet_and_the_base(written: tuple[Any, Path]) -> None:
    exported, folder = written
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
def test_the_sheet_in_space_is_the_shape_on_its_needles(written: tuple[Any, Path]) -> None:
    exported, folder = written
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


def test_without_a_shape_all_lies_in_a_plane(tmp_path: Path) -> None:
    write_rhino(tmp_path / "model.3dm", job())
    found = by_layer(tmp_path / "model.3dm")
    assert sorted(found) == ["base::drilling", "print::needles", "print::outline", "print::plastic"]
    assert all(thing.Geometry.GetBoundingBox().Max.Z == 0.0 for things in found.values() for thing in things)


def test_other_names_and_a_missing_package_are_refused(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"--format = 'stp': must be 3dm; all other formats are always written"):
        asterism.export(dome(), tmp_path / "out", asterism.ExportSettings(formats=("stp",)))
    monkeypatch.setitem(sys.modules, "rhino3dm", None)
    with pytest.raises(
        DesignError, match=r'''--format = '3dm': needs rhino3dm: pip install "asterism-fabric\[cad\]"'''
    ):
        demanded_formats(["3DM"])
    assert not (tmp_path / "out").exists()
