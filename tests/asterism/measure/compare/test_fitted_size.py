"""Scans that are too large or too small."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from asterism.equilibrium.arrays import Floats
from asterism.measure.compare.scan import Scan
from asterism.measure.compare.scan_comparison import ScanComparison, compare_scan, fitted_size
from asterism.pattern import gallery
from asterism.pattern.geometry.normals import vertex_normals
from asterism.previews.session import preview
from asterism.shape.shape import Shape
from tests.asterism.measure.compare.scans import bent_sheet, motion, scanned
from tests.asterism.sheets import dome, sheet


def laid(shape: Shape, ratio: float, part: float = 1.0) -> ScanComparison:
    """A scan of so many times its size."""
    points, _ = scanned(shape, 5, 0.05, part, other=0.0)
    rotation, shift = motion(5)
    return compare_scan(shape, Scan(ratio * points @ rotation.T + shift, 0, len(points)))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("form", "ratio"),
    [("bent", 0.95), ("bent", 1.12), ("dome", 0.95), ("dome", 1.0), ("dome", 1.12)],
)
def test_the_size_of_a_whole_scan_is_found(form: str, ratio: float) -> None:
    numbers = laid(bent_sheet() if form == "bent" else sheet(dome), ratio).distances()
    assert numbers["best_size"] == pytest.approx(ratio, abs=0.005)
    assert numbers["rms_percent_at_best_size"] < 0.2
    if ratio != 1.0:
        assert numbers["rms_percent"] > 1.2 * numbers["rms_percent_at_best_size"]


@pytest.mark.slow
def test_a_part_fits_in_many_sizes() -> None:
    numbers = laid(bent_sheet(), 1.05, part=0.7).distances()
    assert numbers["best_size"] is None and numbers["rms_percent_at_best_size"] is None


@pytest.mark.slow
def test_one_side_of_a_roll_is_no_other_size() -> None:
    """Of a tube every parallel surface is one of another radius; its length tells."""
    shape = preview(gallery.load("fig8-l-uniform"))
    for off_mm, scale in ((-0.5, 1.0), (0.5, 1.0), (0.5, 1.04)):
        side = replace(shape, positions=shape.positions + off_mm * vertex_normals(shape.positions, shape.triangles))
        points, _ = scanned(side, 5, 0.05, other=0.0)
        size = compare_scan(shape, Scan(scale * points, 0, len(points))).size
        assert size is not None
        assert size.lifted_rms_mm < 0.6 * size.rms_mm if scale == 1.0 else size.lifted_rms_mm > size.rms_mm


@pytest.mark.slow
def test_a_scan_is_lifted_by_no_more_than_a_sheet_is_thick() -> None:
    """By 2 mm: what lies farther off is no other side of the sheet."""

    def roll(points: Floats) -> Floats:
        x, y = points.T
        return np.column_stack([30.0 * np.sin(x / 30.0), y, 30.0 * np.cos(x / 30.0)])

    shape = sheet(roll, edge=3.0)
    for off_mm in (1.0, 3.0, -3.0):
        side = replace(shape, positions=shape.positions + off_mm * vertex_normals(shape.positions, shape.triangles))
        size = fitted_size(shape, scanned(side, 5, 0.05, other=0.0)[0], 10.0)
        assert size is not None and (size.lifted_rms_mm > 0.3) == (abs(off_mm) > 2.0)
