"""What is written as VTU is read back unchanged."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np

from asterism.shape.vtu import write_rods_vtu, write_shape_vtu
from tests.asterism import sheets


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
