"""Lines imported from SVG and DXF: places, layers, widths and units, and what is refused."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.drawing.read import read_drawing
from asterism.pattern.drawing.records import DrawingError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout

INKSCAPE = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
SVG = f"""<svg {INKSCAPE} width="100mm" height="80mm" viewBox="0 0 100 80">
<defs><marker id="m"><path d="M0 0L5 5" stroke="black"/></marker></defs>
<g inkscape:groupmode="layer" inkscape:label="rim" id="layer1">
  <circle cx="50" cy="40" r="30" style="fill:none;stroke:#000;stroke-width:1.6"/></g>
<g inkscape:groupmode="layer" inkscape:label="ribs" id="layer2" transform="translate(10,0) scale(2)">
  <path d="M 5 20 L 35 20 M 20 5 C 22 10 18 14 20 20" style="fill:none;stroke:#f00;stroke-width:0.6"/></g>
<g inkscape:label="notes" style="display:none"><path d="M 5 2 L 35 20" stroke="red"/></g>
<rect x="1" y="1" width="3" height="3" fill="red"/>
</svg>"""


def svg(folder: Path, text: str = SVG) -> Path:
    path = folder / "leaf.svg"
    path.write_text(text, encoding="utf-8")
    return path


def dxf(folder: Path, units: int = 4, scale: float = 1.0) -> Path:
    """The same drawing as a CAD program writes it, the stem as a block."""
    drawing = ezdxf.new(units=units)
    space = drawing.modelspace()
    space.add_circle((50 * scale, -40 * scale), 30 * scale, dxfattribs={"layer": "rim"})
    line = [(20 * scale, -40 * scale), (80 * scale, -40 * scale)]
    space.add_lwpolyline(line, dxfattribs={"layer": "ribs", "const_width": 1.2 * scale})
    stem = drawing.blocks.new("stem")
    control = [(0, 30), (4, 20), (-4, 12), (0, 0)]
    stem.add_open_spline([(x * scale, y * scale, 0) for x, y in control], dxfattribs={"layer": "ribs"})
    space.add_blockref("stem", (50 * scale, -40 * scale))
    path = folder / "leaf.dxf"
    drawing.saveas(path)
    return path


def sheet(folder: Path, **entry: Any) -> Layout:
    data = {"rods": {"import": [entry]}, "border": {"rods": "rim"}}
    return layout(Design.from_dict(data, folder))


@pytest.mark.parametrize(("units", "scale"), [(4, 1.0), (5, 0.1), (1, 1 / 25.4)])
def test_dxf_has_the_places_of_the_svg_in_any_unit(tmp_path: Path, units: int, scale: float) -> None:
    lines = read_drawing(dxf(tmp_path, units, scale), 0.005).lines
    assert sorted(line.layer for line in lines) == ["ribs", "ribs", "rim"]
    (rim,) = [line for line in lines if line.layer == "rim"]
    assert np.linalg.norm(rim.points - [50, -40], axis=1) == pytest.approx(30.0, abs=0.01)
    widths = [line.width_mm for line in lines if line.layer == "ribs"]
    assert sorted(width or 0.0 for width in widths) == pytest.approx([0.0, 1.2])


@pytest.mark.parametrize("make", [svg, dxf])
def test_both_files_become_the_same_graph(tmp_path: Path, make: Any) -> None:
    layers = {"rim": {"thickness_mm": 0.8, "width_mm": 1.6}, "ribs": {"thickness_mm": 0.4}}
    plan = sheet(tmp_path, file=make(tmp_path).name, layers=layers)
    assert len(plan.rim) == 3 and len(plan.graph.joints) == 4
    assert sorted({rod.name for rod in plan.graph.rods}) == ["ribs", "rim"]
    assert {float(rod.thickness[0]) for rod in plan.graph.rods if rod.name == "rim"} == {0.8}
    assert np.abs(plan.outline).max() == pytest.approx(30.0, abs=0.02)  # its middle is the origin


def test_stroke_gives_the_width_and_a_saved_design_needs_no_file(tmp_path: Path) -> None:
    entry = {"file": svg(tmp_path).name, "width": "stroke"}
    design = Design.from_dict({"rods": {"import": [entry]}, "border": {"rods": "rim"}}, tmp_path)
    (tmp_path / "leaf.svg").unlink()
    again = Design.from_dict(design.to_dict(), tmp_path)
    assert again == design
    widths = {rod.name: float(rod.width[0]) for rod in layout(again).graph.rods}
    assert widths == pytest.approx({"rim": 1.6, "ribs": 1.2}, rel=1e-4)


REFUSED = [
    ("none.svg", None, {}, "there is no such file"),
    ("leaf.ai", "x", {}, "must end in .svg, .dxf or .3dm"),
    ("leaf.svg", SVG.replace('width="100mm" height="80mm"', ""), {}, "has no size in mm: give it one"),
    ("leaf.svg", "<svg", {}, "cannot be read as SVG"),
    ("leaf.svg", SVG.replace("stroke:", "strike:"), {}, "holds no line with a stroke"),
    ("leaf.svg", SVG, {"layers": {"ribz": {}}}, "layers.ribz: no such layer; the drawing has ribs, rim"),
    ("leaf.dxf", "not a drawing", {}, "cannot be read as DXF"),
]


@pytest.mark.parametrize(("name", "text", "entry", "words"), REFUSED, ids=[words[:30] for *_, words in REFUSED])
def test_what_is_refused(tmp_path: Path, name: str, text: str | None, entry: dict[str, Any], words: str) -> None:
    if text is not None:
        (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(DesignError) as caught:
        sheet(tmp_path, file=name, **entry)
    assert words in str(caught.value) and "\n" not in str(caught.value)
    assert str(caught.value).startswith("rods.import[0].")


def test_without_the_package_for_dxf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = dxf(tmp_path)
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(DrawingError, match="needs ezdxf: pip install"):
        read_drawing(file, 0.005)
