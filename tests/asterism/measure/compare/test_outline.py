"""Outlines: files, the silhouette of a shape, and laying one on the other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from asterism.measure.compare.outline import fit_outline, read_outline, silhouette
from asterism.measure.compare.scan import ScanError
from asterism.results.csv_cells import TableError
from tests.asterism.sheets import dome, flat, sheet, tube

SVG = '<svg xmlns="http://www.w3.org/2000/svg" {size}>{body}</svg>'
RECT = '<rect x="10" y="10" width="50" height="20"/>'


@pytest.mark.parametrize(
    ("size", "scale"),
    [
        ('width="100mm" height="100mm" viewBox="0 0 100 100"', 1.0),
        ('width="100mm" height="80mm"', 25.4 / 96),  # without a viewBox a unit is a pixel, whatever the size
        ('viewBox="0 0 100 100"', 1.0),
    ],
)
def test_svg_in_mm(size: str, scale: float, tmp_path: Path) -> None:
    (tmp_path / "a.svg").write_text(SVG.format(size=size, body=RECT + '<circle cx="2" cy="2" r="1"/>'))
    outline = read_outline(tmp_path / "a.svg")
    corners = outline.corners
    # y upwards, and the larger one of both
    assert outline.lines == 2 and (outline.unit is None) == ("width" in size)
    np.testing.assert_allclose(corners.min(axis=0), [10 * scale, -30 * scale], rtol=1e-5)
    np.testing.assert_allclose(corners.max(axis=0), [60 * scale, -10 * scale], rtol=1e-5)


def test_csv(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x_mm;y_mm\n0;0\n10;0\n10;10\n0;0\n")
    np.testing.assert_array_equal(read_outline(tmp_path / "a.csv", "cm").corners, [[0, 0], [100, 0], [100, 100]])


@pytest.mark.parametrize(
    ("name", "text", "problem"),
    [
        ("a.svg", SVG.format(size='width="10cm" height="10cm"', body=RECT), "its own size: --units"),
        ("a.svg", SVG.format(size="", body=""), "no line"),
        ("a.svg", "<html></html>", "is not a drawing in SVG"),
        ("a.csv", "x_mm,y_mm\n0,0\n10,10\n10,0\n0,10\n", "crosses itself"),
        ("a.csv", "x_mm,y_mm\n0,0\n10,10\n", "at least three"),
        ("a.csv", "x_mm,y_mm\n1," + "9" * 140_000, "row 2: field larger"),
        ("a.csv", "x_mm,y_mm\n1,nan\n", "row 2, column y_mm.*finite"),
    ],
)
def test_mistakes(name: str, text: str, problem: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises((ScanError, TableError), match=problem):
        read_outline(tmp_path / name, "cm")


def test_silhouettes() -> None:
    plate = sheet(flat, 100, 80, 5.0)
    assert shapely.Polygon(silhouette(plate, "above")).area == pytest.approx(8000, rel=1e-3)
    # a spiral that is seen from its end is a line, drawn around on both sides
    rolled = shapely.Polygon(silhouette(sheet(tube, 100, 80, 3.0), "side"))
    assert rolled.length == pytest.approx(2 * 80, rel=0.05)
    low = silhouette(sheet(dome, 100, 80, 3.0), "front")
    assert np.ptp(low[:, 0]) > 2 * np.ptp(low[:, 1])


@pytest.mark.slow
def test_known_motions_are_undone_and_mirrored_outlines_stay_mirrored() -> None:
    turn = 2.0
    corners = np.array([[0, 0], [90, 0], [90, 40], [40, 60], [0, 40]], dtype=float)
    cos, sin = np.cos(turn), np.sin(turn)
    found = fit_outline(corners @ np.array([[cos, sin], [-sin, cos]]) + [300, -20], corners)
    np.testing.assert_allclose(found.outline, corners, atol=0.05)
    assert np.abs(found.distance).max() < 0.05 and found.missed.max() < 0.05
    corners[-1] = [0, 20]
    assert np.abs(fit_outline(corners * [-1, 1], corners).distance).max() > 3


@pytest.mark.slow
def test_a_larger_outline_is_outside() -> None:
    corners = np.array([[0, 0], [90, 0], [90, 40], [0, 40]], dtype=float)
    larger = shapely.get_coordinates(shapely.buffer(shapely.Polygon(corners), 2.0, join_style="mitre"))[:-1]
    assert fit_outline(larger, corners).distance.mean() == pytest.approx(2.0, abs=0.1)
    assert fit_outline(corners, larger).distance.mean() == pytest.approx(-2.0, abs=0.1)
