"""Drawings with groups, blocks and copies at random, read as by the simplest reader: one that walks the tree."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import ezdxf
import numpy as np
import pytest

from asterism.pattern.drawing.read import read_drawing
from asterism.pattern.drawing.records import DrawingError

NAMES = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
# layer, and the ends of a line in mm
Found = list[tuple[str, np.ndarray]]


def compared(path: Path, expected: Found, scale: float = 1.0) -> None:
    """Both have the same lines in the same layers, in any order."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            lines = read_drawing(path, 0.005).lines
        except DrawingError as error:
            assert "holds no line" in str(error) and not expected
            return
    # lines that are as short as rounding may be one point
    read = [(line.layer, line.points) for line in lines if np.ptp(line.points, axis=0).max() > 1e-2]
    left = [(layer, scale * ends) for layer, ends in expected if np.ptp(scale * ends, axis=0).max() > 1e-2]
    for layer, ends in read:
        # svgelements counts 25.4 mm an inch to 6 digits
        same = (k for k, (other, others) in enumerate(left) if other == layer and np.allclose(others, ends, 2e-6, 1e-4))
        found = next(same, None)
        assert found is not None, (layer, ends)
        left.pop(found)
    assert not left


class Svg:
    """A random drawing in SVG."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([3, seed])
        self.ids: list[str] = []
        shared = "".join(self.shared(k) for k in range(4))
        drawn = "".join(self.element(0) for _ in range(4))
        self.unit, self.per_mm = [("mm", 1.0), ("cm", 10.0), ("in", 25.4), (" MM", 1.0)][seed % 4]
        self.size = 100.0 * int(self.rng.integers(1, 4))
        size = f'width="{self.size / self.per_mm!r}{self.unit}" height="{self.size / self.per_mm!r}{self.unit}"'
        self.text = f'<svg {NAMES} {size} viewBox="0 0 50 50"><defs>{shared}</defs>{drawn}</svg>'

    def is_one(self, part: float) -> bool:
        return bool(self.rng.random() < part)

    def number(self) -> float:
        return float(self.rng.integers(1, 40)) / 4.0

    def looks(self) -> str:
        seen = ['opacity="1"', 'style="opacity:0.5"', ""]
        unseen = [
            'display="none"',
            'style="display:none"',
            'opacity="0"',
            'visibility="hidden"',
            'visibility="visible"',
        ]
        return str(self.rng.choice(unseen if self.is_one(0.2) else seen))

    def placed(self) -> str:
        x, y = self.number(), self.number()
        kinds = [
            "",
            f'transform="translate({x},{y})"',
            f'transform="matrix(0,1,-1,0,{x},{y})"',
            'transform="scale(0.5)"',
        ]
        return str(self.rng.choice(kinds))

    def line(self) -> str:
        dx, dy = self.number(), self.number()
        stroke = self.rng.choice(["stroke='#102030'", "stroke='none'"], p=[0.9, 0.1])
        return f"<path fill='none' {stroke} {self.looks()} d='M{self.number()} {self.number()}l{dx} {dy}'/>"

    def shared(self, number: int) -> str:
        tag, box = ("symbol", 'viewBox="0 0 20 20"') if self.is_one(0.5) else ("g", self.placed())
        inner = "".join(self.element(2) for _ in range(2))
        self.ids.append(f"s{number}")
        return f'<{tag} id="s{number}" {box} {self.looks()}>{inner}</{tag}>'

    def element(self, depth: int) -> str:
        kind = self.rng.random() if depth < 5 else 0.0
        if kind < 0.3:
            return self.line()
        if kind < 0.5 and self.ids:
            name, sized = self.rng.choice(self.ids), f'width="{self.number()}" height="{self.number()}"'
            at = f'x="{self.number()}" y="{self.number()}" {sized if self.is_one(0.5) else ""}'
            return f'<use href="#{name}" {at} {self.placed()} {self.looks()}/>'
        inner = "".join(self.element(depth + 1) for _ in range(2))
        if kind < 0.6:
            size = f'width="{self.number()}" height="50%"' if self.is_one(0.5) else ""
            box = 'viewBox="1 2 16 8"' if self.is_one(0.7) else ""
            return f'<svg x="{self.number()}" {size} {box} {self.looks()}>{inner}</svg>'
        name = f"n{self.rng.integers(20)}"
        named = str(self.rng.choice(["", f'inkscape:label="{name}"', f'id="g{name}"']))
        layer = f'inkscape:groupmode="layer" inkscape:label="{name}"' if self.is_one(0.3) else named
        return f"<g {layer} {self.placed()} {self.looks()}>{inner}</g>"


def moved(x: float, y: float, scale: float = 1.0) -> np.ndarray:
    return np.array([[scale, 0.0, x], [0.0, scale, y], [0.0, 0.0, 1.0]])


def lines_of(
    element: Any, ids: dict[str, Any], matrix: np.ndarray, size: tuple[float, float], layer: tuple[str, bool], seen: str
) -> Found:
    """The lines below an element, in pixels with y upwards."""
    tag = element.tag.rpartition("}")[2]
    own = dict(re.findall(r"([\w-]+):([^;]+)", element.get("style", ""))) | element.attrib
    if own.get("display") == "none" or float(own.get("opacity", 1.0)) == 0.0:
        return []
    seen = own.get("visibility", seen)
    if transform := own.get("transform"):
        values = [float(value) for value in re.findall(r"[-\d.]+", transform)]
        if transform.startswith("translate"):
            matrix = matrix @ moved(*values)
        elif transform.startswith("scale"):
            matrix = matrix @ moved(0.0, 0.0, *values)
        else:
            a, b, c, d, e, f = values
            matrix = matrix @ np.array([[a, c, e], [b, d, f], [0, 0, 1]])
    if tag == "path":
        if seen == "hidden" or own["stroke"] == "none":
            return []
        x, y, dx, dy = (float(value) for value in re.findall(r"[-\d.]+", own["d"]))
        ends = np.array([[x, y, 1.0], [x + dx, y + dy, 1.0]]) @ matrix.T
        return [(layer[0] or "#102030", ends[:, :2] * [1.0, -1.0])]
    if tag == "use":
        matrix = matrix @ moved(float(own.get("x", 0)), float(own.get("y", 0)))
        used = ids[own["href"][1:]]
        if used.tag.endswith("symbol"):
            used = ElementTree.fromstring(ElementTree.tostring(used))
            used.attrib |= {side: own[side] for side in ("width", "height") if side in own}
        return lines_of(used, ids, matrix, size, layer, seen)
    if tag in ("svg", "symbol"):
        width, height = (
            float(text[:-1]) * whole / 100 if (text := own.get(side, "100%")).endswith("%") else float(text)
            for side, whole in zip(("width", "height"), size, strict=True)
        )
        matrix, size = matrix @ moved(float(own.get("x", 0)), float(own.get("y", 0))), (width, height)
        if box := own.get("viewBox"):
            left, top, *size_of = (float(value) for value in box.split())
            scale = min(width / size_of[0], height / size_of[1])
            matrix = matrix @ moved((width - scale * size_of[0]) / 2, (height - scale * size_of[1]) / 2, scale)
            matrix, size = matrix @ moved(-left, -top), (size_of[0], size_of[1])
    if tag == "g":
        name = own.get(f"{INKSCAPE}label") or own.get("id")
        if own.get(f"{INKSCAPE}groupmode") == "layer":
            layer = (name or "", True)
        elif name and not layer[1]:
            layer = (name, False)
    children = [child for child in element if not child.tag.endswith(("defs", "symbol"))]
    return [line for child in children for line in lines_of(child, ids, matrix, size, layer, seen)]


@pytest.mark.parametrize("first", range(0, 120, 30))
def test_svg_is_read_as_a_tree(first: int, tmp_path: Path) -> None:
    count = 0
    for seed in range(first, first + 30):
        drawing = Svg(seed)
        (tmp_path / "x.svg").write_text(drawing.text)
        root = ElementTree.fromstring(drawing.text)
        ids = {element.get("id", ""): element for element in reversed(list(root.iter()))}
        inner = ElementTree.Element("{}g")
        inner.extend(list(root))
        found = lines_of(inner, ids, np.eye(3), (50.0, 50.0), ("", False), "visible")
        compared(tmp_path / "x.svg", found, drawing.size / 50.0)
        count += len(found)
    assert count > 300


LAYERS = ("0", "ribs", "rim", "off", "frozen")


def random_dxf(seed: int, path: Path) -> Any:
    """Blocks of lines and of earlier blocks, in several places, sizes, directions and arrays."""
    rng = np.random.default_rng([4, seed])
    drawing = ezdxf.new(units=int(rng.choice([4, 5, 1])))
    drawing.layers.add("off").off()
    drawing.layers.add("frozen").freeze()
    rooms = [drawing.blocks.new(f"b{k}") for k in range(4)]
    for level, room in enumerate([*rooms, drawing.modelspace()]):
        for _ in range(3):
            on = {"layer": str(rng.choice(LAYERS, p=[0.4, 0.25, 0.2, 0.1, 0.05])), "invisible": int(rng.random() < 0.1)}
            x, y, dx, dy = rng.integers(1, 40, 4).tolist()
            room.add_line((x, y), (x + dx, y - dy), dxfattribs=on)
            if level and rng.random() < 0.7:
                scale = float(rng.choice([0.5, 1.0, 2.0]))
                on |= {"rotation": float(rng.integers(360)), "xscale": scale, "yscale": scale * rng.choice([-1.0, 1.0])}
                insert = room.add_blockref(f"b{rng.integers(level)}", (y, x), dxfattribs=on | {"zscale": scale})
                if rng.random() < 0.3:
                    insert.grid((2, 2), (7.0, 9.0))
    drawing.saveas(path)
    return drawing


def entities_of(drawing: Any, room: Any, matrix: np.ndarray, outer: str) -> Found:
    """The lines of a block, in the unit of the drawing."""
    found: Found = []
    for entity in room:
        layer = outer if entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxf.get("invisible", 0) or layer == "frozen":
            continue
        if entity.dxftype() == "LINE" and layer != "off":
            ends = np.array([[*entity.dxf.start.vec2, 1.0], [*entity.dxf.end.vec2, 1.0]]) @ matrix.T
            found.append((layer, ends[:, :2]))
        elif entity.dxftype() == "INSERT":
            turn = np.radians(entity.dxf.rotation)
            cos, sin = np.cos(turn), np.sin(turn)
            turned = np.array([[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])
            stretched = np.diag([entity.dxf.xscale, entity.dxf.yscale, 1.0])
            for row in range(entity.dxf.row_count):
                for column in range(entity.dxf.column_count):
                    step = moved(column * entity.dxf.column_spacing, row * entity.dxf.row_spacing)
                    inner = matrix @ moved(*entity.dxf.insert.vec2) @ turned @ step @ stretched
                    found += entities_of(drawing, drawing.blocks[entity.dxf.name], inner, layer)
    return found


@pytest.mark.parametrize("first", range(0, 60, 20))
def test_dxf_is_read_as_a_tree(first: int, tmp_path: Path) -> None:
    count = 0
    for seed in range(first, first + 20):
        drawing = random_dxf(seed, tmp_path / "x.dxf")
        found = entities_of(drawing, drawing.modelspace(), np.eye(3), "0")
        mm = {4: 1.0, 5: 10.0, 1: 25.4}[drawing.header["$INSUNITS"]]
        compared(tmp_path / "x.dxf", found, mm)
        count += len(found)
    assert count > 300
