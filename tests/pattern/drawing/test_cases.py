"""Drawings as programs write them: sizes, layers, what is hidden, what is used, gaps, and what is refused.

One drawing as SVG and as DXF becomes the same rods.
"""

from __future__ import annotations

import re
import sys
import time
from itertools import pairwise
from pathlib import Path
from typing import Any

import ezdxf
import numpy as np
import pytest

from asterism.measure.outline import read_outline
from asterism.measure.scan import ScanError
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.drawing.read import Drawing, read_drawing
from asterism.pattern.drawing.records import DrawingError, DrawingWarning, NoUnitError
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.layout import Layout
from tests.pattern.drawing import rhino_drawing

NAMES = (
    'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
)
MM = 'width="100mm" height="80mm" viewBox="0 0 100 80"'
LINE = '<path fill="none" stroke="#000" stroke-width="1.2" '
RECTANGLE = f'{LINE} d="M10 10H90V70H10Z"/>'
FOUR = "".join(f'{LINE} d="{d}"/>' for d in ("M10 10H90", "M90 10V70", "M90 70H10", "M10 70V10"))
SQUARE = [(0.0, 0.0), (80.0, 0.0), (80.0, 60.0), (0.0, 60.0)]


def svg(folder: Path, body: str, size: str = MM) -> Path:
    path = folder / "x.svg"
    path.write_text(f"<svg {NAMES} {size}>{body}</svg>", encoding="utf-8")
    return path


def dxf(folder: Path, draw: Any, units: int = 4) -> Path:
    drawing = ezdxf.new(units=units)
    draw(drawing.modelspace())
    drawing.saveas(folder / "x.dxf")
    return folder / "x.dxf"


def sides(space: Any, gap: float = 0.0) -> None:
    for start, end in zip(SQUARE, SQUARE[1:] + SQUARE[:1], strict=True):
        space.add_line((start[0] + gap, start[1]), end)


def outline_size(path: Path, **keys: Any) -> np.ndarray:
    """(2,) mm, of the outline that a design takes from a file."""
    data = {"stars": {"length_mm": 6.0}, "border": {"file": path.name, **keys}}
    return np.asarray(np.ptp(np.array(Design.from_dict(data, path.parent).border.polygon_mm), axis=0))


def read(path: Path) -> Drawing:
    return read_drawing(path, 0.005)


@pytest.mark.parametrize(
    ("body", "size"),
    [
        (RECTANGLE, MM),
        (RECTANGLE, 'width="100 mm" height="80 mm" viewBox="0 0 100 80"'),
        (RECTANGLE, 'width="100MM" height=" 8CM" viewBox="0 0 100 80"'),
        (f'<svg viewBox="0 0 10 8">{LINE} d="M1 1H9V7H1Z"/></svg>', MM),
        (f'<svg x="5" y="5" width="50%" height="50%" viewBox="0 0 50 40">{RECTANGLE}</svg>', MM),
        (f'<svg x="5"><g><svg y="3">{RECTANGLE}</svg></g></svg>', MM),
        (f'<symbol id="s" viewBox="0 0 10 8">{LINE} d="M1 1H9V7H1Z"/></symbol><use href="#s"/>', MM),
        (f'<g display="inline"><a href="#x"><switch>{RECTANGLE}</switch></a></g>', MM),
        (f'<rect class="no" width="99" height="70" stroke="red"/><style>.no{{display:none}}</style>{RECTANGLE}', MM),
        ('<rect x="10%" y="12.5%" width="80%" height="75%" fill="none" stroke="url(#colours)"/>', MM),
        (f'<svg width="auto" height="auto" viewBox="0 0 100 80">{RECTANGLE}</svg>', MM),
        (FOUR, MM),
        (f'{LINE} d="M10 10H90V70H10V10.004"/>', MM),
    ],
)
def test_an_outline_of_80_x_60_mm(body: str, size: str, tmp_path: Path) -> None:
    path = svg(tmp_path, body, size)
    assert outline_size(path) == pytest.approx([80.0, 60.0], abs=1e-3)
    assert np.ptp(read_outline(path).corners, axis=0) == pytest.approx([80.0, 60.0], abs=1e-3)
    assert read(path).size_mm == pytest.approx([80.0, 60.0], abs=1e-2)


def test_a_size_in_pixels_names_what_it_may_be(tmp_path: Path) -> None:
    path = svg(tmp_path, RECTANGLE, 'width="377.95" height="302.36" viewBox="0 0 100 80"')
    said = r'its size in px.*"mm" makes it 302.4 x 226.8 mm, "px" makes it 80 x 60 mm, "pt"'
    with pytest.raises(DesignError, match=said):
        outline_size(path)
    assert outline_size(path, units="px") == pytest.approx([80.0, 60.0], abs=1e-2)
    with pytest.raises(ScanError, match=r"size in px: give width and height in mm$"):
        read_outline(path)
    sizeless = svg(tmp_path, RECTANGLE, 'width="auto" height="AUTO" viewBox="0 0 100 80"')
    assert outline_size(sizeless, units="mm") == pytest.approx([80.0, 60.0])
    path = svg(tmp_path, RECTANGLE, 'width="377.95" height="302.36" viewBox="0 0 100 80"')
    # Illustrator's points, with its entities
    text = path.read_text().replace(NAMES, 'xmlns="&ns;"').replace("377.95", "283.46").replace("302.36", "226.77")
    path.write_text(f'<!DOCTYPE svg [<!ENTITY ns "http://www.w3.org/2000/svg">]>{text}')
    assert outline_size(path, units="pt") == pytest.approx([80.0, 60.0], abs=1e-2)


@pytest.mark.parametrize(
    "hidden",
    [
        f'{LINE} stroke-opacity="0" d="M0 0H5"/>',
        f'{LINE} opacity="0" d="M0 0H5"/>',
        f'{LINE} style="stroke-width:0" d="M0 0H5"/>',
        f'{LINE} visibility="hidden" d="M0 0H5"/>',
        f'{LINE} style="stroke:rgba(0,0,0,0)" d="M0 0H5"/>',
        f'<g opacity="0.0"><g opacity="1">{LINE} opacity="1" d="M0 0H5"/></g></g>',
        f'<g style="display:none"><g display="inline">{LINE} d="M0 0H5"/></g></g>',
        '<path fill="none" d="M0 0H5"/>',
        f'<marker>{RECTANGLE}</marker><clipPath>{RECTANGLE}</clipPath><path fill="none" d="M0 0H5"/>',
    ],
)
def test_what_cannot_be_seen_is_left_out_and_said(hidden: str, tmp_path: Path) -> None:
    said = r"x.svg: read 1 line in 1 layer, 80 x 60 mm; left out: 1 (hidden line|line in)"
    with pytest.warns(DrawingWarning, match=said):
        assert len(read(svg(tmp_path, hidden + RECTANGLE)).lines) == 1


def test_all_that_is_left_out_is_counted(tmp_path: Path) -> None:
    body = (
        f'<g id="a">{RECTANGLE}<text>a<tspan>b</tspan></text><text>c</text><image href="a.png"/></g>{LINE} d="M5 5H9"/>'
    )
    body += f'<g display="none">{3 * RECTANGLE}</g><rect width="5" height="5"/>'
    body += f'<style>.cut{{clip-path:url(#c)}}</style><g class="cut" mask="url(#m)">{LINE} d="M-50 40H150"/></g>'
    with pytest.warns(DrawingWarning) as caught:
        read(svg(tmp_path, body))
    assert str(caught[0].message) == (
        "x.svg: read 3 lines in 2 layers, 200 x 65 mm; left out: 2 texts, 1 picture, 1 clip path, "
        "whose lines are whole, 1 mask, whose lines are whole, 3 lines in hidden layers, 1 fill without a stroke"
    )
    with pytest.raises(DrawingError, match=r"holds no line with a stroke; left out: 1 text$"):
        read(svg(tmp_path, "<text>a</text>"))


def test_one_shift_for_outline_and_rods_of_a_file(tmp_path: Path) -> None:
    layer = '<g inkscape:groupmode="layer" inkscape:label="{}">{} d="{}"/></g>'
    drawn = {"cut": "M10 10H90V70H10Z", "ribs": "M20 40H80", "title": "M100 40H130", "eye": "M20 20H30V30Z"}
    body = "".join(layer.format(name, LINE, d) for name, d in drawn.items())
    svg(tmp_path, body, 'width="400mm" height="100mm" viewBox="0 0 400 100"')
    rods = {"import": [{"file": "x.svg", "layers": {"ribs": {}}}]}
    border: dict[str, Any] = {"file": "x.svg", "layer": "cut", "holes": [{"file": "x.svg", "layer": "eye"}]}
    design = Design.from_dict({"rods": rods, "border": border}, tmp_path)
    assert design.rods is not None
    assert np.array(design.rods.on_sheet[0].line_mm) == pytest.approx(np.array([[-30, 0], [30, 0]]), abs=1e-4)
    assert np.array(design.border.holes[0].rings_mm[0])[0] == pytest.approx([-30, 20], abs=1e-4)
    rods["import"] += [{"file": "./x.svg", "layers": {"cut": {}}}]
    alone = Design.from_dict({"rods": rods, "border": {"rectangle_mm": [90, 90]}}, tmp_path).rods
    assert alone is not None  # the middle of both tables, not of each
    assert np.array(alone.on_sheet[0].line_mm) == pytest.approx(np.array([[-30, 0], [30, 0]]), abs=1e-4)
    again = Design.from_dict(design.to_dict())
    assert again == design


def test_a_stretched_stroke_matters_for_widths_only(tmp_path: Path) -> None:
    circle = '<circle transform="scale(2,1)" cx="25" cy="40" r="20" fill="none" stroke="#000"/>'
    path = svg(tmp_path, circle)
    assert outline_size(path) == pytest.approx([80.0, 40.0], abs=1e-2)
    rods: dict[str, Any] = {"file": path.name, "width": "stroke"}
    said = r"import\[0\].file = 'x.svg': Circle is drawn with a stroke stretched 2 to 1"
    with pytest.raises(DesignError, match=said):
        Design.from_dict({"rods": {"import": [rods]}, "border": {"rectangle_mm": [99, 99]}}, tmp_path)


@pytest.mark.slow
def test_lines_of_a_cad_program_are_an_outline(tmp_path: Path) -> None:
    assert outline_size(dxf(tmp_path, sides)) == pytest.approx([80.0, 60.0])
    assert outline_size(dxf(tmp_path, lambda space: sides(space, 0.003))) == pytest.approx([80.0, 60.0], abs=0.01)
    with pytest.raises(DesignError, match="must have a closed line"):
        outline_size(dxf(tmp_path, lambda space: sides(space, 0.3)))

    def fine(space: Any) -> None:
        angles = np.linspace(0.0, 2.0 * np.pi, 900)  # lines that are shorter than a gap
        places = np.column_stack([np.cos(angles), np.sin(angles)]).tolist()
        for start, end in pairwise(places):
            space.add_line(start, end)

    def plate(space: Any) -> None:
        sides(space)
        space.add_circle((40, 30), 20)

    path = dxf(tmp_path, fine)
    assert outline_size(path) == pytest.approx([2.0, 2.0], abs=1e-3)
    path = dxf(tmp_path, plate)
    assert outline_size(path) == pytest.approx([80.0, 60.0])
    data = {"stars": {"length_mm": 6.0}, "border": {"file": path.name}}
    assert len(Design.from_dict(data, tmp_path).border.holes) == 1


def test_blocks_in_blocks_may_be_stretched_in_any_direction(tmp_path: Path) -> None:
    """A square turned by 45 degrees and stretched twice as long becomes a rhombus."""

    def draw(space: Any) -> None:
        inner, outer = space.doc.blocks.new("inner"), space.doc.blocks.new("outer")
        inner.add_lwpolyline([(0, 0), (10, 0), (10, 10), (0, 10)], close=True)
        inner.add_circle((0, 0), 50)
        outer.add_blockref("inner", (0, 0), dxfattribs={"rotation": 45})
        space.add_blockref("outer", (0, 0), dxfattribs={"xscale": 2})
        space.add_lwpolyline([(0, 0), (9, 0)], dxfattribs={"const_width": 1.5})
        outer.add_lwpolyline([(0, 0), (9, 0)], dxfattribs={"const_width": 1.5})
        space.add_blockref("outer", (900, 0), dxfattribs={"xscale": 2, "yscale": -2})

    square, circle, wide, plain, *_, twice = read(dxf(tmp_path, draw)).lines
    side = np.sqrt(50.0)
    corners = np.array([[0, 0], [2 * side, side], [0, 2 * side], [-2 * side, side], [0, 0]])
    assert square.points == pytest.approx(corners, abs=1e-9)
    assert np.hypot(circle.points[:, 0] / 2, circle.points[:, 1]) == pytest.approx(50.0, abs=1e-5)
    assert (plain.width_mm, twice.width_mm) == (1.5, pytest.approx(3.0))
    assert wide.width_mm == pytest.approx(1.5 * np.sqrt(2.0))


def test_odd_drawings_of_cad_programs(tmp_path: Path) -> None:
    """Names that differ by case, a block that is missing, entities with one handle."""

    def draw(space: Any) -> None:
        space.doc.layers.add("Ribs")
        for name in ("ribs", "RIBS", "Ribs"):
            space.add_line((0, 0), (80, 60), dxfattribs={"layer": name})
        space.add_blockref("missing", (0, 0))

    path = dxf(tmp_path, draw)
    first, *others = re.findall(r"\nLINE\n  5\n\w+\n", path.read_text())[-3:]
    for other in others:
        path.write_text(path.read_text().replace(other, first))
    with pytest.warns(DrawingWarning, match="read 3 lines in 1 layer, 80 x 60 mm; left out: 1 damaged part$"):
        assert [line.layer for line in read(path).lines] == 3 * ["Ribs"]


def test_hidden_lines_of_dxf(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        layers = space.doc.layers
        layers.add("off").off()
        layers.add("frozen").freeze()
        block = space.doc.blocks.new("block")
        for layer in ("0", "on"):
            block.add_line((0, 0), (1, 1), dxfattribs={"layer": layer})
        for layer in ("on", "off", "frozen"):
            space.add_line((0, 0), (80, 60), dxfattribs={"layer": layer})
            # layers that are off show what is on other layers, and frozen ones do not
            space.add_blockref("block", (5, 5), dxfattribs={"layer": layer})
        space.add_line((0, 0), (1, 0), dxfattribs={"invisible": 1})
        space.add_text("a")
        space.add_mtext("b")
        space.add_polymesh()

    with pytest.warns(DrawingWarning, match="left out: 5 lines in hidden layers, 1 hidden line, 2 texts, 1 mesh$"):
        assert [line.layer for line in read(dxf(tmp_path, draw)).lines] == ["on"] * 4


def test_splines_are_read_over_their_domain(tmp_path: Path) -> None:
    def draw(space: Any) -> None:
        points = [(0, 0, 0), (10, 20, 0), (30, -20, 0), (40, 0, 0), (50, 10, 0)]
        loose = space.add_spline(degree=3)
        loose.control_points, loose.knots = points, range(9)
        circle = space.add_spline(degree=2)  # with weights: a quarter of a circle
        circle.control_points, circle.knots = [(9, 0, 0), (9, 9, 0), (0, 9, 0)], [0, 0, 0, 1, 1, 1]
        circle.weights = [1.0, np.sqrt(0.5), 1.0]
        corner = space.add_spline(degree=1)
        corner.control_points, corner.knots = [(0, 0, 0), (30, 0, 0), (30, 7, 0)], [0, 0, 0.3, 1, 1]

    loose, circle, corner = read(dxf(tmp_path, draw)).lines
    assert loose.points[[0, -1]] == pytest.approx(np.array([[35 / 3, 10], [40, -5 / 3]]), abs=1e-9)
    assert np.linalg.norm(circle.points, axis=1) == pytest.approx(9.0, abs=1e-9)
    assert corner.points == pytest.approx(np.array([[0, 0], [30, 0], [30, 7]]))


def test_unknown_units_of_dxf_can_be_given(tmp_path: Path) -> None:
    path = dxf(tmp_path, sides, 0)
    path.write_text(path.read_text().replace("$INSUNITS\n 70\n0\n", "$INSUNITS\n 70\n99\n"))
    said = r'unknown unit \(\$INSUNITS = 99\).*"mm" makes it 80 x 60 mm, "cm" makes it 800'
    with pytest.raises(NoUnitError, match=said):
        read(path)
    assert outline_size(path, units="mm") == pytest.approx([80.0, 60.0])


def test_a_drawing_far_from_its_origin_is_shifted(tmp_path: Path) -> None:
    places = [(x + 3.5e8, y + 5.6e8) for x, y in SQUARE]
    path = dxf(tmp_path, lambda space: (space.add_lwpolyline(places, close=True), space.add_line((0, 0), (9, 0))))
    assert outline_size(path) == pytest.approx([80.0, 60.0], abs=1e-6)


def test_what_is_not_in_the_model_space_is_counted(tmp_path: Path) -> None:
    """External references, lines in paper space, and the end of a file that is cut short."""

    def draw(space: Any) -> None:
        sides(space)
        space.doc.add_xref_def("walls.dxf", "walls")
        space.add_blockref("walls", (0, 0))
        space.doc.layout("Layout1").add_circle((0, 0), 9)
        space.doc.layout("Layout1").add_text("a")

    path = dxf(tmp_path, draw)
    with pytest.warns(DrawingWarning, match="read 4 lines.*left out: 1 object in paper space, 1 external reference$"):
        assert read(path).size_mm == pytest.approx([80.0, 60.0])
    text = path.read_text()
    path.write_text(text[: text.rindex("\nLINE\n")])
    with pytest.raises(DrawingError, match="holds no line with a stroke; left out: 1 damaged part"):
        read(path)


@pytest.mark.slow
def test_places_and_shapes_beyond_reason_are_refused_at_once(tmp_path: Path) -> None:
    def spline(space: Any) -> None:
        curve = space.add_spline(degree=3)
        curve.control_points, curve.knots = [(0, 0, 0), (np.nan, 1, 0), (2, 2, 0), (5, 5, 0), (6, 6, 0)], range(9)

    start = time.process_time()
    for place in (1e300, np.nan, np.inf):
        with pytest.raises(DrawingError, match=r"no sensible numbers: LINE \w+ in layer 'ribs'"):
            read(dxf(tmp_path, lambda space, x=place: space.add_line((0, 0), (x, 1), dxfattribs={"layer": "ribs"})))
    for d in ("M0 0L1e300 1", "M0 0C1 1 1e300 1 2 2"):
        with pytest.raises(DrawingError, match="no sensible numbers: p1 in layer 'ribs'"):
            read(svg(tmp_path, f'<g id="ribs">{LINE} id="p1" d="{d}"/></g>'))
    with pytest.raises(DrawingError, match=r"LINE \w+ in layer '0' is 1e\+06 x 0 mm large: at most 200 m"):
        read(dxf(tmp_path, lambda space: space.add_line((0, 0), (1e6, 0))))
    for draw in (
        lambda space: space.add_arc((0, 0), 1e308, 0, 90),
        lambda space: space.add_lwpolyline([(0, 0, 0, 0, 1e154), (10, 0)]),
        spline,
    ):
        with pytest.raises(DrawingError, match=r"holds (what is no line|places that .*): [A-Z]+ \w+ in layer '0'"):
            read(dxf(tmp_path, draw))
    for size in (1e7, 1e300):
        with pytest.raises(DrawingError, match=r"no sensible numbers: Circle in layer|at most 200 m are allowed"):
            read(svg(tmp_path, f'<circle r="{size}" fill="none" stroke="#000"/>'))
        with pytest.raises(DrawingError, match=r"no sensible numbers: CIRCLE|at most 200 m are allowed"):
            read(dxf(tmp_path, lambda space, size=size: space.add_circle((0, 0), size)))
    assert time.process_time() - start < 20.0


@pytest.mark.parametrize("box", ["0 0 0 0", "0 0 10", "a b c d", "0 0 nan 80"])
def test_a_view_box_is_four_numbers_and_decimals_have_a_point(box: str, tmp_path: Path) -> None:
    with pytest.raises(DrawingError, match=f"has the viewBox '{box}': must be four numbers, the last two above 0"):
        read(svg(tmp_path, RECTANGLE, f'width="100mm" height="80mm" viewBox="{box}"'))
    with pytest.raises(DrawingError, match="'100,0mm': must be a number and a unit, 120mm; decimals have a point"):
        read(svg(tmp_path, RECTANGLE, f'width="100,0mm" height="80,0mm" viewBox="{box}"'))


@pytest.mark.parametrize("code", [".", "x", "0x4", "9" * 5000])
def test_a_unit_code_may_be_anything(code: str, tmp_path: Path) -> None:
    path = dxf(tmp_path, sides)
    path.write_text(path.read_text().replace("$INSUNITS\n 70\n4\n", f"$INSUNITS\n 70\n{code}\n"))
    with pytest.raises(DrawingError) as caught:
        read(path)
    assert len(str(caught.value)) < 400


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (b"AutoCAD Binary DXF\r\n\x1a\x00", "binary DXF"),
        (b"AC1027\0", "DWG"),
        (b"<!DOCTYPE html>", "HTML or XML"),
        (b"x", "no"),
    ],
)
def test_what_is_no_text_dxf_is_named(content: bytes, kind: str, tmp_path: Path) -> None:
    (tmp_path / "x.dxf").write_bytes(content)
    with pytest.raises(DrawingError, match=f"it is {kind}.*: save the drawing as text DXF"):
        read(tmp_path / "x.dxf")


@pytest.mark.slow
def test_endless_drawings_end_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for reader in ("svg", "dxf"):
        monkeypatch.setattr(f"asterism.pattern.drawing.{reader}.MAX_ELEMENTS", 5000)
    uses = (
        "".join(f'<g id="g{k}">{10 * f"<use href=#g{k + 1}/>"}</g>' for k in range(8))
        .replace("#", '"#')
        .replace("/>", '"/>')
    )
    for body, words in (
        (f'<g id="a"><use href="#a"/>{RECTANGLE}</g>', "or an element that uses itself"),
        ('<symbol id="a"><use href="#a"/></symbol><use href="#a"/>', "or an element that uses itself"),
        (f"{20_000 * '<g>'}{RECTANGLE}{20_000 * '</g>'}", "has groups more than 100 deep"),
        (f'<defs>{uses}<g id="g8">{RECTANGLE}</g></defs><use href="#g0"/>', "more than 5000 elements"),
    ):
        with pytest.raises(DrawingError, match=words):
            read(svg(tmp_path, body))

    def nested(space: Any, grid: int) -> None:
        for k in range(8):
            block = space.doc.blocks.new(f"b{k}")
            block.add_line((0, 0), (1, 0))
            block.add_blockref(f"b{k + 1}", (0, 0)).grid((grid, 10), (1, 1))
        space.doc.blocks.new("b8").add_line((0, 0), (1, 0))
        space.add_blockref("b0", (0, 0))

    with pytest.raises(DrawingError, match="more than 5000 entities"):
        read(dxf(tmp_path, lambda space: nested(space, 10)))
    with pytest.raises(DrawingError, match="blocks more than 100 deep, or one that holds itself"):
        read(dxf(tmp_path, holding_itself))
    with pytest.raises(DrawingError, match="more than 5000 entities"):
        read(dxf(tmp_path, array))


def array(space: Any) -> None:
    space.doc.blocks.new("b")
    space.add_blockref("b", (0, 0)).grid((30_000, 30_000), (1, 1))


def holding_itself(space: Any) -> None:
    block = space.doc.blocks.new("b")
    block.add_line((0, 0), (1, 0))
    block.add_blockref("b", (0, 0))
    space.add_blockref("b", (0, 0))


def test_blocks_of_rhino(tmp_path: Path) -> None:
    rhino: Any = pytest.importorskip("rhino3dm")
    drawing = rhino_drawing.Drawing()
    blocks, objects, move = drawing.file.InstanceDefinitions, drawing.file.Objects, rhino.Transform.Translation
    origin = rhino.Point3d(0, 0, 0)
    ring = rhino.Circle(origin, 8.0).ToNurbsCurve()
    blocks.Add("ring", "", "", "", origin, (ring,), (drawing.on("cut"),))
    objects.AddInstanceObject(rhino.InstanceReference(blocks[0].Id, move(60, 45, 0)), drawing.on("other"))
    objects.AddInstanceObject(rhino.InstanceReference(blocks[0].Id, move(0, 0, 0)), drawing.on("off", visible=False))
    drawing.on("parent", visible=False)
    drawing.polyline(SQUARE, "parent::child")
    with pytest.warns(DrawingWarning, match="left out: 2 lines in hidden layers"):
        (line,) = read(drawing.saved(tmp_path)).lines
    assert line.layer == "cut"
    assert np.linalg.norm(line.points - [60, 45], axis=1) == pytest.approx(8.0, abs=1e-6)


@pytest.mark.parametrize("layer", ["a\tb", "a]\u200db\u202e", 'it"s "#1"', "\u00c4ste & <R\u00fccken>", " "])
def test_odd_names_of_layers(layer: str, tmp_path: Path) -> None:
    path = dxf(tmp_path, lambda space: space.add_line((0, 0), (80, 0), dxfattribs={"layer": "x"}))
    path.write_text(path.read_text().replace("\nx\n", f"\n{layer}\n"), encoding="utf-8")
    rods = {"import": [{"file": path.name, "layers": {layer: {}}}]}
    design = Design.from_dict({"rods": rods, "border": {"rectangle_mm": [99, 99]}}, tmp_path)
    assert design.rods is not None and design.rods.on_sheet[0].name.isprintable()
    with pytest.raises(DesignError) as caught:
        Design.from_dict(
            {"rods": {"import": [{**rods["import"][0], "layers": {"y": {}}}]}, "border": {"rings": 2}}, tmp_path
        )
    assert str(caught.value).isprintable()


LEAF = f"""<svg {NAMES} width="100mm" height="80mm" viewBox="0 0 100 80">
<defs><marker id="m"><path d="M0 0L5 5" stroke="black"/></marker></defs>
<g inkscape:groupmode="layer" inkscape:label="rim" id="layer1">
  <circle cx="50" cy="40" r="30" style="fill:none;stroke:#000;stroke-width:1.6"/></g>
<g inkscape:groupmode="layer" inkscape:label="ribs" id="layer2" transform="translate(10,0) scale(2)">
  <path d="M 5 20 L 35 20 M 20 5 C 22 10 18 14 20 20" style="fill:none;stroke:#f00;stroke-width:0.6"/></g>
<g inkscape:label="notes" style="display:none"><path d="M 5 2 L 35 20" stroke="red"/></g>
<rect x="1" y="1" width="3" height="3" fill="red"/>
</svg>"""


def leaf_svg(folder: Path, text: str = LEAF) -> Path:
    path = folder / "leaf.svg"
    path.write_text(text, encoding="utf-8")
    return path


def leaf_dxf(folder: Path, units: int = 4, scale: float = 1.0) -> Path:
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
    lines = read_drawing(leaf_dxf(tmp_path, units, scale), 0.005).lines
    assert sorted(line.layer for line in lines) == ["ribs", "ribs", "rim"]
    (rim,) = [line for line in lines if line.layer == "rim"]
    assert np.linalg.norm(rim.points - [50, -40], axis=1) == pytest.approx(30.0, abs=0.01)
    widths = [line.width_mm for line in lines if line.layer == "ribs"]
    assert sorted(width or 0.0 for width in widths) == pytest.approx([0.0, 1.2])


@pytest.mark.parametrize("make", [leaf_svg, leaf_dxf])
def test_both_files_become_the_same_graph(tmp_path: Path, make: Any) -> None:
    layers = {"rim": {"thickness_mm": 0.8, "width_mm": 1.6}, "ribs": {"thickness_mm": 0.4}}
    plan = sheet(tmp_path, file=make(tmp_path).name, layers=layers)
    assert len(plan.rim) == 3 and len(plan.graph.joints) == 4
    assert sorted({rod.name for rod in plan.graph.rods}) == ["ribs", "rim"]
    assert {float(rod.thickness[0]) for rod in plan.graph.rods if rod.name == "rim"} == {0.8}
    assert np.abs(plan.outline).max() == pytest.approx(30.0, abs=0.02)  # its middle is the origin


def test_stroke_gives_the_width_and_a_saved_design_needs_no_file(tmp_path: Path) -> None:
    entry = {"file": leaf_svg(tmp_path).name, "width": "stroke"}
    design = Design.from_dict({"rods": {"import": [entry]}, "border": {"rods": "rim"}}, tmp_path)
    (tmp_path / "leaf.svg").unlink()
    again = Design.from_dict(design.to_dict(), tmp_path)
    assert again == design
    widths = {rod.name: float(rod.width[0]) for rod in layout(again).graph.rods}
    assert widths == pytest.approx({"rim": 1.6, "ribs": 1.2}, rel=1e-4)


REFUSED = [
    ("none.svg", None, {}, "there is no such file"),
    ("leaf.ai", "x", {}, "must end in .svg, .dxf or .3dm"),
    ("leaf.svg", LEAF.replace('width="100mm" height="80mm"', ""), {}, "has no size in mm: give it one"),
    ("leaf.svg", "<svg", {}, "cannot be read as SVG"),
    ("leaf.svg", LEAF.replace("stroke:", "strike:"), {}, "holds no line with a stroke"),
    ("leaf.svg", LEAF, {"layers": {"ribz": {}}}, "layers.ribz: no such layer; the drawing has ribs, rim"),
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
    file = leaf_dxf(tmp_path)
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(DrawingError, match="needs ezdxf: pip install"):
        read_drawing(file, 0.005)
