"""Drawings with groups, blocks and copies at random, and the simplest reader of them: one that walks the tree."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import ezdxf
import numpy as np

from asterism.pattern.drawing.read import read_drawing
from asterism.pattern.drawing.records import DrawingError

NAMES = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
NAMES_OF_LAYERS = (
    "ribs",
    "Ribs",
    "RIBS ",
    "0",
    "#000000",
    "R\u00fccken &amp; Rand",
    "a\u00a0b",
    "\u202ec",
    "a,b:c",
    "=1+1",
)
SVG_UNITS = (("mm", 1.0), ("cm", 10.0), ("in", 25.4), (" MM", 1.0))
# layer, and the ends of a line in mm
Found = list[tuple[str, np.ndarray]]


def difference(path: Path) -> str:
    """What the reader and the recursive one have not in common, in words; empty if they agree."""
    if path.suffix == ".svg":
        root = ElementTree.parse(path).getroot()
        ids = {element.get("id", ""): element for element in reversed(list(root.iter()))}
        size, inner = float(root.get("width", "").lower().rstrip(" cimn")), ElementTree.Element("{}g")
        inner.extend(list(root))
        scale = size * next(mm for unit, mm in SVG_UNITS if root.get("width", "").endswith(unit)) / 50.0
        expected = svg_lines(inner, ids, np.eye(3), (50.0, 50.0), ("", False), "visible")
    else:
        drawing = ezdxf.readfile(path)
        scale = {4: 1.0, 5: 10.0, 1: 25.4}[drawing.header["$INSUNITS"]]
        expected = dxf_lines(drawing, drawing.modelspace(), np.eye(3), "0")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            lines = read_drawing(path, 0.005).lines
        except DrawingError as error:
            return f"refused: {error}" if expected or "holds no line" not in str(error) else ""
    # lines that are as short as rounding may be one point
    read = [(line.layer, line.points) for line in lines if np.ptp(line.points, axis=0).max() > 1e-2]
    left = [(layer, scale * ends) for layer, ends in expected if np.ptp(scale * ends, axis=0).max() > 1e-2]
    for layer, ends in read:
        # svgelements counts 25.4 mm an inch to 6 digits
        same = (k for k, (other, others) in enumerate(left) if other == layer and np.allclose(others, ends, 2e-6, 1e-4))
        if (found := next(same, None)) is None:
            return f"a line too many: {layer!r} {ends.tolist()}"
        left.pop(found)
    return f"a line is missing: {left[0]}" if left else ""


class Svg:
    """A random drawing in SVG."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([3, seed])
        self.ids: list[str] = []
        shared = "".join(self.shared(k) for k in range(4))
        drawn = "".join(self.element(0) for _ in range(4))
        self.unit, self.per_mm = SVG_UNITS[seed % 4]
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
            f'transform="scale(0.5,1.5) rotate({x * 9})"',
            f'transform="skewX({x}) translate({y})"',
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
        name = str(self.rng.choice(NAMES_OF_LAYERS))
        named = str(self.rng.choice(["", f'inkscape:label="{name}"', f'id="g {name}"']))
        layer = f'inkscape:groupmode="layer" inkscape:label="{name}"' if self.is_one(0.3) else named
        return f"<g {layer} {self.placed()} {self.looks()}>{inner}</g>"


def moved(x: float, y: float, scale: float = 1.0) -> np.ndarray:
    return np.array([[scale, 0.0, x], [0.0, scale, y], [0.0, 0.0, 1.0]])


def transformed(kind: str, values: list[float]) -> np.ndarray:
    first, second = values[0], values[-1]
    turn = np.radians(first)
    if kind == "translate":
        return moved(first, second if len(values) > 1 else 0.0)
    rows = {
        "scale": [[first, 0], [0, second]],
        "rotate": [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]],
        "skewX": [[1, np.tan(turn)], [0, 1]],
        "matrix": np.reshape(values[:4], (2, 2)).T if len(values) == 6 else None,
    }
    matrix = np.eye(3)
    matrix[:2, :2] = rows[kind]
    matrix[:2, 2] = values[4:] if kind == "matrix" else 0.0
    return matrix


def svg_lines(
    element: Any, ids: dict[str, Any], matrix: np.ndarray, size: tuple[float, float], layer: tuple[str, bool], seen: str
) -> Found:
    """The lines below an element, in pixels with y upwards."""
    tag = element.tag.rpartition("}")[2]
    own = dict(re.findall(r"([\w-]+):([^;]+)", element.get("style", ""))) | element.attrib
    if own.get("display") == "none" or float(own.get("opacity", 1.0)) == 0.0:
        return []
    seen = own.get("visibility", seen)
    for kind, text in re.findall(r"(\w+)\(([^)]*)\)", own.get("transform", "")):
        matrix = matrix @ transformed(kind, [float(value) for value in text.split(",")])
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
        return svg_lines(used, ids, matrix, size, layer, seen)
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
    return [line for child in children for line in svg_lines(child, ids, matrix, size, layer, seen)]


LAYERS = ("0", "ribs", "RIBS", "rim", "off", "Frozen")


def write_nested(seed: int, folder: Path) -> Path:
    """Write a random drawing in DXF or SVG."""
    if seed % 2:
        random_dxf(seed, folder / "nested.dxf")
        return folder / "nested.dxf"
    (folder / "nested.svg").write_text(Svg(seed // 2).text, encoding="utf-8")
    return folder / "nested.svg"


def random_dxf(seed: int, path: Path) -> Any:
    """Blocks of lines and of earlier blocks, in several places, sizes, directions and arrays."""
    rng = np.random.default_rng([4, seed])
    drawing = ezdxf.new(units=int(rng.choice([4, 5, 1])))
    drawing.layers.add("off").off()
    drawing.layers.add("frozen").freeze()
    drawing.layers.add("Ribs")
    rooms = [drawing.blocks.new(f"b{k}", base_point=rng.integers(9, size=2)) for k in range(4)]
    for level, room in enumerate([*rooms, drawing.modelspace()]):
        for _ in range(3):
            on = {
                "layer": str(rng.choice(LAYERS, p=[0.4, 0.15, 0.1, 0.2, 0.1, 0.05])),
                "invisible": int(rng.random() < 0.1),
            }
            x, y, dx, dy = rng.integers(1, 40, 4).tolist()
            room.add_line((x, y), (x + dx, y - dy), dxfattribs=on)
            if level and rng.random() < 0.7:
                scale = float(rng.choice([0.5, 1.0, 2.0]))
                on |= {
                    "rotation": float(rng.integers(360)),
                    "xscale": scale,
                    "yscale": scale * rng.choice([-1.0, 1.0, 0.7]),
                }
                insert = room.add_blockref(f"b{rng.integers(level)}", (y, x), dxfattribs=on | {"zscale": scale})
                if rng.random() < 0.3:
                    insert.grid((2, 2), (7.0, 9.0))
    drawing.saveas(path)
    return drawing


def dxf_lines(drawing: Any, room: Any, matrix: np.ndarray, outer: str) -> Found:
    """The lines of a block, in the unit of the drawing."""
    found: Found = []
    for entity in room:
        layer = outer if entity.dxf.layer == "0" else entity.dxf.layer
        layer = {"ribs": "Ribs", "frozen": "frozen"}.get(layer.lower(), layer)
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
                    block = drawing.blocks[entity.dxf.name]
                    inner = matrix @ moved(*entity.dxf.insert.vec2) @ turned @ step @ stretched
                    found += dxf_lines(drawing, block, inner @ moved(*-block.block.dxf.base_point.vec2), layer)
    return found
