"""Drawings that become rods, the outline, or both: units, layers, what stays, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asterism.pattern.design.errors import DesignError
from asterism.studio.document import Document
from asterism.studio.drawing import Drawings, UploadError, read_drawing, with_drawing
from asterism.studio.requests import PlaceDrawing
from tests.asterism.studio.test_uploads import dxf

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="60mm" viewBox="0 0 100 60">
<g id="cut" fill="none" stroke="black" stroke-width="0.1">
<rect x="10" y="10" width="80" height="40"/><circle cx="70" cy="20" r="4"/></g>
<g id="ribs" fill="none" stroke="black" stroke-width="1.6"><path d="M20 30H80"/><path d="M40 20V45"/></g>
<g id="rim" fill="none" stroke="black" stroke-width="2"><ellipse cx="40" cy="30" rx="25" ry="15"/></g>
<g id="notes" fill="none" stroke="red"><path d="M0 0L3 0"/></g>
<g id="beside" fill="none" stroke="red"><circle cx="4" cy="4" r="2"/></g></svg>"""


@pytest.fixture
def document(folder: Path) -> Document:
    return Document.open(folder / "dome.toml")


def placed(document: Document, tmp_path: Path, name: str, content: bytes | str, **choice: Any) -> dict[str, Any]:
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    drawing = read_drawing(path, name)
    request = PlaceDrawing.model_validate({"type": "drawing", "drawing": 1, **choice})
    table, _ = with_drawing(document.table, drawing, request, document.layout.outline)
    document.apply(table, None, name)
    document.end_gesture()
    return document.table


@pytest.mark.slow
def test_layers_become_rods_and_the_outline_with_its_holes(document: Document, tmp_path: Path) -> None:
    layers = {"cut": {"use": "outline"}, "ribs": {"use": "rods", "thickness": 0.5, "width": 1.4}}
    table = placed(document, tmp_path, "plan.svg", SVG, layers=layers)
    assert "stars" not in table and table["rods"]["thickness_mm"] == 0.5 and table["rods"]["width_mm"] == 1.4
    layout = document.layout
    assert np.ptp(layout.outline, axis=0) == pytest.approx([80.0, 40.0]) and len(layout.holes) == 1
    low, high = layout.holes[0].min(axis=0), layout.holes[0].max(axis=0)
    assert (low + high) / 2 == pytest.approx([20.0, 10.0], abs=0.01)  # y points upwards
    assert sum(rod.length for rod in layout.drawn_rods) == pytest.approx(60 + 25)
    document.undo()
    assert "rods" not in document.table and document.text == document.path.read_text(encoding="utf-8")


def test_the_saved_design_needs_no_file(document: Document, tmp_path: Path) -> None:
    placed(document, tmp_path, "plan.svg", SVG, layers={"ribs": {"use": "rods"}}, sheet="around", strokes=True)
    (tmp_path / "plan.svg").unlink()
    document.save()
    again = Document.open(document.path).layout
    assert [rod.width[0] for rod in again.drawn_rods] == pytest.approx([1.6] * 4, abs=1e-5)
    assert np.ptp(again.outline, axis=0) == pytest.approx([80.0, 45.0])  # 10 mm around


def test_a_closed_line_can_be_rod_and_outline(document: Document, tmp_path: Path) -> None:
    layers = {"rim": {"use": "both", "width": 2.0}, "ribs": {"use": "rods", "width": 1.0}}
    table = placed(document, tmp_path, "leaf.svg", SVG, layers=layers)
    assert table["border"]["rods"] == "rim" and "width_mm" not in table["rods"]
    assert np.ptp(document.layout.outline, axis=0) == pytest.approx([50.0, 30.0], abs=0.001)
    assert document.layout.rim


@pytest.mark.slow
def test_the_pattern_that_is_there_can_stay(document: Document, tmp_path: Path) -> None:
    circle = dxf(lambda space: space.add_circle((0, 0), 58, dxfattribs={"layer": "ring"}))
    table = placed(document, tmp_path, "ring.dxf", circle, layers={"ring": {"use": "outline"}}, keep=True)
    assert table["stars"] == Document.open(document.path).table["stars"] and "rods" not in table
    with pytest.raises(DesignError, match="crosses"):
        line = dxf(lambda space: space.add_line((-20, 0), (20, 0)))
        placed(document, tmp_path, "line.dxf", line, layers={"0": {"use": "rods"}}, keep=True)
    assert document.table == table


@pytest.mark.parametrize(
    "layers, problem",
    [
        ({"ribs": {"use": "outline"}}, "plan.svg: ribs: an outline must have a closed line"),
        ({"other": {"use": "rods"}}, "choose a layer"),
        ({"ribs": {"use": "rods", "width": 30.0}}, "width_mm"),
        ({"cut": {"use": "outline"}, "beside": {"use": "outline"}}, "a closed line lies beside it"),
    ],
)
def test_a_refused_drawing_changes_nothing(document: Document, tmp_path: Path, layers: Any, problem: str) -> None:
    before = document.table
    with pytest.raises((UploadError, DesignError), match=problem) as refusal:
        placed(document, tmp_path, "plan.svg", SVG, layers=layers)
    assert document.table == before and "\n" not in str(refusal.value)


def test_supports_that_another_outline_does_not_reach_are_left_out_with_a_line(tmp_path: Path) -> None:
    pins: list[dict[str, Any]] = [
        {
            "points_mm": [(0, 0), (55, 0), (20, 10), (-30, -15)],
            "target_mm": [(0, 0, 1), (55, 0, 2), (0, 0, 3), (9, 9, 4)],
        },
        {"points_mm": [(-55, 0)], "target_mm": (0, 0, 9)},
        {"edges": [0]},
        {"where": "corners", "scale": 0.9},
    ]
    table = {"stars": {"length_mm": 8.0}, "border": {"rectangle_mm": (120, 100)}, "pins": pins}
    path = tmp_path / "plan.svg"
    path.write_text(SVG, encoding="utf-8")
    drawing = read_drawing(path, path.name)
    layers = {"cut": {"use": "outline"}}  # 80 x 40 mm, with a hole of 8 mm at [20, 10]
    request = PlaceDrawing.model_validate({"type": "drawing", "drawing": 1, "layers": layers})
    placed_table, note = with_drawing(table, drawing, request, np.zeros((0, 2)))
    assert placed_table["pins"] == [{"points_mm": [(0, 0), (-30, -15)], "target_mm": [(0, 0, 1), (9, 9, 4)]}, pins[3]]
    assert note == "4 supports of the former outline are left out; Undo brings the former sheet back."
    assert with_drawing({**table, "pins": pins[3:]}, drawing, request, np.zeros((0, 2)))[1] == ""


def test_the_last_drawings_are_kept(tmp_path: Path) -> None:
    (tmp_path / "plan.svg").write_text(SVG, encoding="utf-8")
    drawing, kept = read_drawing(tmp_path / "plan.svg", "plan.svg"), Drawings()
    numbers = [kept.add(drawing) for _ in range(6)]
    assert kept.get(numbers[-1]) is drawing
    with pytest.raises(UploadError):
        kept.get(numbers[0])
