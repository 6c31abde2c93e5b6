"""Results read back as the shape that wrote them."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

import asterism
from asterism.pattern.design.errors import DesignError
from asterism.shape.shape import Shape
from asterism.shape.vtu import read_shape, write_rods_vtu, write_shape_vtu
from tests.asterism import sheets


@pytest.fixture(scope="module")
def shape() -> Shape:
    # arms reach the neighbours' centres: rods share vertices
    stars = {"length_fraction": 1.0, "thickness_mm": 0.5, "width_mm": 0.8}
    design = asterism.Design.from_dict({"stars": stars, "border": {"rings": 1}, "mesh": {"edge_mm": 5.0}})
    return asterism.simulate(design, starts=1)


@pytest.fixture(scope="module")
def written(shape: Shape, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("results") / "out"
    asterism.write_results(shape, path)
    return path


@pytest.fixture
def results(written: Path, tmp_path: Path) -> Path:
    """A copy to spoil."""
    return Path(shutil.copytree(written, tmp_path / "out"))


@pytest.mark.slow
def test_a_result_is_read_as_it_was(shape: Shape, results: Path) -> None:
    for path in (results, results / "shape.vtu"):
        again = read_shape(path)
        for name in ("printed", "positions", "triangles", "star", "star_vertices", "rod_edges"):
            assert np.array_equal(getattr(again, name), getattr(shape, name)), name
        for name in ("point_fields", "cell_fields", "rod_fields"):
            old, new = getattr(shape, name), getattr(again, name)
            assert set(old) == set(new)
            assert all(np.array_equal(old[key], new[key], equal_nan=True) for key in old)
        assert again.summary["design"] == shape.summary["design"]
        assert again.at(np.array([[3.0, 4.0]])) == pytest.approx(shape.at(np.array([[3.0, 4.0]])))


def test_the_sheet_alone_is_enough(results: Path) -> None:
    (results / "rods.vtu").unlink()
    (results / "summary.json").unlink()
    again = read_shape(results)
    assert again.rods == () and again.summary == {} and len(again.triangles)


def test_a_held_sheet_stays_one(results: Path) -> None:
    assert not read_shape(results).held
    summary = json.loads((results / "summary.json").read_text())
    summary["design"]["pins"] = [{"where": "corners"}]
    (results / "summary.json").write_text(json.dumps(summary))
    assert read_shape(results).held


def test_what_is_not_a_shape_is_named(results: Path, tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r"nowhere.shape\.vtu: is not there|nowhere: is not there"):
        read_shape(tmp_path / "nowhere")
    (results / "rods.vtu").write_bytes((results / "shape.vtu").read_bytes())
    with pytest.raises(DesignError, match=r"rods\.vtu: must hold lines"):
        read_shape(results)
    (results / "rods.vtu").unlink()
    whole = (results / "shape.vtu").read_bytes()
    for broken in (b"", b"not xml", whole[: len(whole) // 2], whole.replace(b"printed_mm", b"something_")):
        (results / "shape.vtu").write_bytes(broken)
        with pytest.raises(DesignError, match=r"shape\.vtu: (cannot be read|must hold)") as caught:
            read_shape(results)
        assert "\n" not in str(caught.value)
    (results / "shape.vtu").write_bytes(whole)
    (results / "summary.json").write_text("{")
    with pytest.raises(DesignError, match=r"summary\.json: is not JSON"):
        read_shape(results)


def test_a_wrong_corner_or_place_in_a_vtu_is_named(shape: Shape, results: Path) -> None:
    """What no program but an editor writes."""
    for corner in (-1, len(shape.positions)):
        triangles = shape.triangles.copy()
        triangles[3, 1] = corner
        mesh = meshio.read(results / "shape.vtu")
        mesh.cells[0].data = triangles
        meshio.vtu.write(str(results / "shape.vtu"), mesh)
        with pytest.raises(DesignError, match=r"shape\.vtu: must hold triangles of points from 0 to"):
            read_shape(results)
    mesh.cells[0].data = shape.triangles
    mesh.point_data["printed_mm"][5, 0] = np.nan
    meshio.vtu.write(str(results / "shape.vtu"), mesh)
    with pytest.raises(DesignError, match=r"shape\.vtu: must hold points below"):
        read_shape(results)
    mesh.point_data |= {"printed_mm": np.column_stack([shape.printed, shape.star]), "star": shape.star * np.nan}
    meshio.vtu.write(str(results / "shape.vtu"), mesh)
    with pytest.raises(DesignError, match=r"shape\.vtu: must hold whole numbers of stars"):
        read_shape(results)
    for printed, positions in ((0.0, 1.0), (1.0, 0.0), (-1.0, 1.0)):
        flat = shape.printed * [printed, 1.0]
        write_shape_vtu(replace(shape, printed=flat, positions=positions * shape.positions), results / "shape.vtu")
        with pytest.raises(DesignError, match=r"shape\.vtu: must hold triangles with an area, counterclockwise"):
            read_shape(results)


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ('{"name": "Gr\xf6\xdfe"}'.encode("latin-1"), "is not UTF-8 text"),
        (b'{"a": ' * 3000 + b"1" + b"}" * 3000, "is nested too deeply"),
        (b"[1, 2]", "must hold a table of keys and values"),
        (b'{"is_minimum": "yes"}', "is_minimum = 'yes': must have the type that asterism writes"),
        (b'{"triangles": null}', "triangles = None: must have"),
        (b'{"energy_n_mm": [1.0]}', "energy_n_mm = [1.0]: must have"),
        (b'{"energy_parts_n_mm": {"bend": true}}', "energy_parts_n_mm = {'bend': True}: must have"),
    ],
)
def test_a_summary_of_another_kind_is_named(content: bytes, problem: str, results: Path) -> None:
    (results / "summary.json").write_bytes(content)
    with pytest.raises(DesignError) as caught:
        read_shape(results)
    assert str(caught.value).startswith(f"{results / 'summary.json'}: {problem}")


def test_a_shape_made_by_hand_has_whole_triangles_of_its_vertices(shape: Shape) -> None:
    for triangles, problem in (
        (shape.triangles + 1, "numbers of vertices from 0 to"),
        (shape.triangles - 1, "numbers of vertices"),
        (shape.triangles.astype(float), "must be whole numbers"),
        (shape.triangles[:, :2], "of the shape"),
    ):
        with pytest.raises(DesignError, match=f"triangles: .*{problem}"):
            replace(shape, triangles=triangles)
    with pytest.raises(DesignError, match="positions: must have the shape"):
        replace(shape, positions=shape.positions[:-1])


def test_other_programs_find_sheet_and_arms_exactly(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    shape = sheets.sheet(sheets.saddle)
    write_shape_vtu(shape, tmp_path / "shape.vtu")
    write_rods_vtu(shape, tmp_path / "rods.vtu")
    assert capfd.readouterr() == ("", "")
    whole, arms = np.arange(len(shape.printed)), np.unique(shape.rod_edges)
    for kind, used, fields in (("triangle", whole, shape.cell_fields), ("line", arms, shape.rod_fields)):
        mesh = meshio.read(tmp_path / ("shape.vtu" if kind == "triangle" else "rods.vtu"))
        assert mesh.points.dtype == np.float64 and np.array_equal(mesh.points, shape.positions[used])
        cells = shape.triangles if kind == "triangle" else shape.rod_edges
        assert np.array_equal(used[mesh.cells_dict[kind]], cells)
        assert np.array_equal(mesh.point_data["printed_mm"], np.pad(shape.printed[used], ((0, 0), (0, 1))))
        assert np.array_equal(mesh.point_data["star"], shape.star[used])
        assert all(np.array_equal(mesh.cell_data_dict[name][kind], values) for name, values in fields.items())
        for name, values in shape.point_fields.items() if kind == "triangle" else ():
            assert np.array_equal(mesh.point_data[name], values, equal_nan=True)


def test_a_sheet_without_stars_is_written_too(tmp_path: Path) -> None:
    shape = replace(sheets.sheet(sheets.flat), rods=(), rod_fields={"arm": np.empty(0, dtype=int)})
    write_rods_vtu(shape, tmp_path / "rods.vtu")
    write_shape_vtu(shape, tmp_path / "shape.vtu")
    assert (tmp_path / "rods.vtu").read_text().rstrip().endswith("</VTKFile>")
    assert len(meshio.read(tmp_path / "shape.vtu").points) == len(shape.printed)
