"""Outlines, holes and curves from 3DM files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.geometry.planar import polygon_area
from asterism.pattern.layout.build import layout as layout_of
from tests.pattern.drawing.rhino_drawing import Drawing

rhino3dm: Any = pytest.importorskip("rhino3dm")
SQUARE = [(0, 0), (120, 0), (120, 90), (0, 90), (0, 0)]


def sheet(folder: Path, **border: Any) -> Design:
    data = {"stars": {"length_mm": 6.0}, "border": {"file": "x.3dm", **border}}
    return Design.from_dict(data, folder)


def test_the_largest_closed_line_is_the_outline_and_those_within_are_holes(tmp_path: Path) -> None:
    drawing = Drawing()
    drawing.circle(60.0, 45.0, 8.0, "cut")
    drawing.polyline(SQUARE, "cut")
    drawing.saved(tmp_path)
    design = sheet(tmp_path)
    layout = layout_of(design)
    assert np.allclose(np.sort(layout.outline, axis=0)[[0, -1]], [[-60, -45], [60, 45]])
    (hole,) = layout.holes
    assert np.allclose(np.linalg.norm(hole, axis=1), 8.0, atol=1e-5)
    assert abs(polygon_area(hole)) == pytest.approx(np.pi * 64.0, rel=0.005)
    # saved designs need no file
    (tmp_path / "x.3dm").unlink()
    assert layout_of(Design.from_dict(design.to_dict())).outline == pytest.approx(layout.outline)


def test_units_origin_and_layer(tmp_path: Path) -> None:
    drawing = Drawing("Centimeters")
    drawing.polyline([(x / 10, y / 10) for x, y in SQUARE], "sheet")
    drawing.polyline([(x + 30, y) for x, y in SQUARE], "beside")
    drawing.saved(tmp_path)
    outline = np.array(sheet(tmp_path, layer="sheet", origin="drawing").border.polygon_mm)
    assert np.allclose(outline, SQUARE[:-1])
    inches = np.array(sheet(tmp_path, layer="sheet", origin="drawing", units="in").border.polygon_mm)
    assert np.allclose(inches, 2.54 * np.array(SQUARE[:-1]))


def test_a_curve_is_near_its_straight_pieces(tmp_path: Path) -> None:
    drawing = Drawing()
    corners = [(0, 0), (70, 20), (120, 0), (100, 60), (120, 110), (50, 90), (0, 110), (20, 50), (0, 0)]
    points = rhino3dm.Point3dList()
    for x, y in corners:
        points.Add(float(x), float(y), 0.0)
    curve = rhino3dm.NurbsCurve.Create(True, 3, points)
    drawing.file.Objects.AddCurve(curve, drawing.on("cut"))
    drawing.saved(tmp_path)
    outline = np.array(sheet(tmp_path, origin="drawing").border.polygon_mm)
    ends = np.roll(outline, -1, axis=0)
    middles = 0.5 * (outline + ends)
    dense = np.linspace(curve.Domain.T0, curve.Domain.T1, 20_001)
    on_curve = np.array([(p.X, p.Y) for p in (curve.PointAt(float(t)) for t in dense)])
    away = np.array([np.linalg.norm(on_curve - middle, axis=1).min() for middle in middles])
    assert away.max() < 0.03 and len(outline) < 1000


def test_curves_are_rods_by_their_layers(tmp_path: Path) -> None:
    drawing = Drawing()
    drawing.polyline([(-40, 0), (40, 0)], "ribs")
    drawing.file.Objects.AddArc(rhino3dm.Arc(rhino3dm.Point3d(0, 0, 0), 30.0, np.pi / 2), drawing.on("arches"))
    drawing.polyline([(0, -40), (0, 40)], "hidden", visible=False)
    drawing.saved(tmp_path, "lines.3dm")
    rods = {"import": [{"file": "lines.3dm", "origin": "drawing"}]}
    design = Design.from_dict({"rods": rods, "border": {"rectangle_mm": [120.0, 120.0]}}, tmp_path)
    assert design.rods is not None
    by_layer = {line.name: np.array(line.line_mm) for line in design.rods.on_sheet}
    assert sorted(by_layer) == ["arches", "ribs"]
    assert np.allclose(by_layer["ribs"], [[-40, 0], [40, 0]])
    arch = by_layer["arches"]
    assert np.allclose(np.linalg.norm(arch, axis=1), 30.0, atol=1e-5) and np.allclose(arch[[0, -1]], [[30, 0], [0, 30]])


def test_wrong_files_end_in_one_line(tmp_path: Path) -> None:
    def problem(**border: Any) -> str:
        with pytest.raises(DesignError) as caught:
            sheet(tmp_path, **border)
        return str(caught.value)

    assert "border.file = 'x.3dm': there is no such file" in problem()
    (tmp_path / "x.3dm").write_bytes(b"3D Geometry File Format        1" + bytes(200))
    assert problem().endswith("cannot be read as 3DM: the file is damaged or cut short")
    drawing = Drawing()
    drawing.polyline([(0, 0), (50, 0)], "open")
    drawing.saved(tmp_path)
    assert problem() == "border.file = 'x.3dm': must have a closed line; layers with one: none"
    drawing.polyline(SQUARE, "cut")
    drawing.polyline([(x + 300, y) for x, y in SQUARE], "other")
    drawing.saved(tmp_path)
    assert "border.layer = 'sheet': must have a closed line; layers with one: cut, other" in problem(layer="sheet")
    assert "must have one outline: a closed line lies beside it, about (300.0, 0.0) mm; choose a layer" in problem()
    assert "must have one of" in problem(rings=2, layer="cut")
    with pytest.raises(DesignError, match=r"border\.layer = 'cut': goes with file"):
        Design.from_dict({"stars": {"length_mm": 6.0}, "border": {"rings": 1, "layer": "cut"}})


def test_a_missing_package_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Drawing().saved(tmp_path)
    monkeypatch.setitem(__import__("sys").modules, "rhino3dm", None)
    said = r'''x\.3dm': reading 3DM needs rhino3dm: pip install "asterism-fabric\[cad\]"'''
    with pytest.raises(DesignError, match=said):
        sheet(tmp_path)
