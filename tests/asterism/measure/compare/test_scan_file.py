"""Damaged files of scans are refused with their place; intact ones are read."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from asterism.measure.compare.errors import ScanError
from asterism.measure.compare.scan import read_scan

PLY = "ply\nformat ascii 1.0\nelement vertex 12\nproperty float x\nproperty float y\nproperty float z\nend_header\n"


def points() -> list[str]:
    return [f"{x} {y} {0.1 * x * y}" for x in range(4) for y in range(3)]


@pytest.mark.parametrize("line", ["v 1 2", "v 1", "v", "v 1 2 x"])
@pytest.mark.parametrize("copies", [1, 3])
def test_a_short_vertex_of_an_obj_is_named(line: str, copies: int, tmp_path: Path) -> None:
    """Three short lines of two numbers make two vertices for a parser that only counts numbers."""
    file = tmp_path / "a.obj"
    file.write_text("\n".join([f"v {point}" for point in points()] + copies * [line]))
    with pytest.raises(ScanError, match="line 13"):
        read_scan(file)


def test_weights_and_colours_of_an_obj_are_read_over(tmp_path: Path) -> None:
    file = tmp_path / "a.obj"
    file.write_text("\n".join(f"v {point} 0.5 0.5 0.5" for point in points()))
    assert read_scan(file).vertices == 12


def test_a_ply_text_that_is_cut_short_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.ply"
    file.write_text(PLY + "\n".join(points()) + "\n")
    assert read_scan(file).vertices == 12
    file.write_text(PLY + "\n".join(points()[:7]) + "\n")
    with pytest.raises(ScanError, match="7 of 12"):
        read_scan(file)
    file.write_text(PLY + "\n".join([*points()[:-1], "1 2"]) + "\n")
    with pytest.raises(ScanError, match="vertex 12"):
        read_scan(file)


def test_a_binary_stl_that_is_cut_short_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    rng = np.random.default_rng(0)
    content = bytes(80) + struct.pack("<I", 20)
    content += b"".join(struct.pack("<12fH", *rng.normal(size=12), 0) for _ in range(20))
    file.write_bytes(content)
    assert read_scan(file).triangles == 20
    file.write_bytes(content[:500])
    with pytest.raises(ScanError, match="8 of 20 triangles"):
        read_scan(file)
