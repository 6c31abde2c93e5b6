"""What is written as VTU is read back unchanged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest

from asterism.shape.vtu import write_rods_vtu, write_shape_vtu
from tests.asterism import sheets


def test_the_sheet_comes_back_exactly(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    shape = sheets.sheet(sheets.saddle)
    write_shape_vtu(shape, tmp_path / "shape.vtu")
    assert capfd.readouterr() == ("", "")
    mesh = meshio.read(tmp_path / "shape.vtu")
    assert mesh.points.dtype == np.float64
    assert np.array_equal(mesh.points, shape.positions)
    assert np.array_equal(mesh.cells_dict["triangle"], shape.triangles)
    assert np.array_equal(mesh.point_data["printed_mm"][:, :2], shape.printed)
    assert np.array_equal(mesh.point_data["printed_mm"][:, 2], np.zeros(len(shape.printed)))
    assert np.array_equal(mesh.point_data["star"], shape.star)
    for name, values in shape.point_fields.items():
        assert np.array_equal(mesh.point_data[name], values, equal_nan=True)
    for name, values in shape.cell_fields.items():
        assert np.array_equal(mesh.cell_data_dict[name]["triangle"], values)


def test_every_star_is_found_at_its_centre(tmp_path: Path) -> None:
    shape = sheets.sheet(sheets.dome)
    write_shape_vtu(shape, tmp_path / "shape.vtu")
    mesh = meshio.read(tmp_path / "shape.vtu")
    for number, vertex in enumerate(shape.star_vertices):
        assert np.flatnonzero(mesh.point_data["star"] == number).tolist() == [vertex]


def test_the_arms_come_back_exactly(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    shape = sheets.sheet(sheets.dome)
    write_rods_vtu(shape, tmp_path / "rods.vtu")
    assert capfd.readouterr() == ("", "")
    mesh = meshio.read(tmp_path / "rods.vtu")
    lines = mesh.cells_dict["line"]
    assert np.array_equal(mesh.points[lines], shape.positions[shape.rod_edges])
    assert np.array_equal(mesh.point_data["printed_mm"][lines][..., :2], shape.printed[shape.rod_edges])
    for name in ("arm", "star", "thickness_mm", "width_mm"):
        assert np.array_equal(mesh.cell_data_dict[name]["line"], shape.rod_fields[name])
    assert len(np.unique(lines)) == len(mesh.points)


def test_a_sheet_without_stars_is_written_too(tmp_path: Path) -> None:
    shape = replace(sheets.sheet(sheets.flat), rods=(), rod_fields={"arm": np.empty(0, dtype=int)})
    write_rods_vtu(shape, tmp_path / "rods.vtu")
    write_shape_vtu(shape, tmp_path / "shape.vtu")
    assert (tmp_path / "rods.vtu").read_text().rstrip().endswith("</VTKFile>")
    assert len(meshio.read(tmp_path / "shape.vtu").points) == len(shape.printed)


def test_flags_are_written_as_numbers(tmp_path: Path) -> None:
    shape = sheets.sheet(sheets.flat, edge=10.0)
    shape = replace(shape, point_fields={"pinned": shape.printed[:, 0] > 0, "single": np.float32(shape.star)})
    write_shape_vtu(shape, tmp_path / "shape.vtu")
    mesh = meshio.read(tmp_path / "shape.vtu")
    assert np.array_equal(mesh.point_data["pinned"], shape.printed[:, 0] > 0)
    assert np.array_equal(mesh.point_data["single"], shape.star)
