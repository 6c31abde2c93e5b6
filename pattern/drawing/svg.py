"""Lines of SVG, by `svgelements`."""

from __future__ import annotations

import itertools
import re
import warnings
from collections import Counter
from collections.abc import Iterator
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.drawing.records import (
    MAX_DEPTH,
    MAX_ELEMENTS,
    MM_OF_UNITS,
    DrawingError,
    FileLine,
    Source,
    checked,
)
from asterism.pattern.geometry.flattening import flattened

_LENGTH_UNITS = ("mm", "cm", "in", "pt", "pc")
# all widths and heights that SVG allows
_SIZE = re.compile(rf"([+]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?({'|'.join(_LENGTH_UNITS)}|px|%|em|ex)?|auto)?")
# points of a curve at which its turn is measured
_CURVE_SAMPLES = 64
# a stroke is stretched unevenly if its widths along x and y differ by more than this part
_MAX_UNEVENNESS = 0.02
_SVG = "{http://www.w3.org/2000/svg}"
_INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
_HREF = ("href", "{http://www.w3.org/1999/xlink}href")
_LAYER = "data-asterism-layer"
_GROUPS = ("g", "a", "switch", "svg", "use")
_SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")
_NAMES = {"text": "text|s", "image": "picture|s", "foreignObject": "foreign object|s"}
_ALONG = ({"x", "width", "cx", "x1", "x2"}, {"y", "height", "cy", "y1", "y2"})
_PLACEMENT = ("x", "y", "width", "height", "viewBox", "preserveAspectRatio", *_HREF)


def open_svg(path: Path, fills: bool) -> Source:
    """The drawing in an SVG file.

    Parameters
    ----------
    fills : shapes that have a fill only are lines too.
    """
    import svgelements as svg  # slow to import, rarely used

    left_out: Counter[str] = Counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            root = ElementTree.fromstring(path.read_bytes())
            if _tag(root) != "svg":
                raise DrawingError("is not a drawing in SVG")
            said = {side: "".join(root.get(side, "").split()).lower() for side in ("width", "height")}
            if odd := next((text for text in said.values() if not _SIZE.fullmatch(text)), None):
                hint = "; decimals have a point" if "," in odd else ""
                raise DrawingError(f"has the size {odd!r}: must be a number and a unit, 120mm{hint}")
            root.attrib |= {side: text for side, text in said.items() if text}
            unfolded = _Unfolded(root, left_out).root
            drawing = svg.SVG.parse(
                BytesIO(ElementTree.tostring(unfolded)), reify=False, ppi=96, parse_display_none=True
            )
    except DrawingError:
        raise
    except Exception as error:  # svgelements raises errors of many kinds on damaged files
        reason = str(error).strip().split("\n")[0] or type(error).__name__
        raise DrawingError(f"cannot be read as SVG: {reason}") from None
    measured = all(text.endswith(_LENGTH_UNITS) for text in said.values())
    problem = "has no size in mm: give it one in the drawing"
    if any(said.values()):
        unit = next((unit for unit in ("%", *_LENGTH_UNITS) if unit in "".join(said.values())), "px")
        problem = f"has its size in {unit}: give width and height in mm"
    # svgelements gives pixels, of which the SVG standard has 96 an inch
    mm = MM_OF_UNITS["px"] if measured else None
    return Source(mm, problem, not any(said.values()), partial(_lines, drawing, fills, left_out))


class _Unfolded:
    """A copy of an SVG tree of groups and shapes only: what is used stands in its place, with the name of its layer."""

    def __init__(self, root: Any, left_out: Counter[str]) -> None:
        self._left_out, self._count = left_out, itertools.count()
        self._by_id: dict[str, Any] = {}
        for element in root.iter():
            self._by_id.setdefault(element.get("id", ""), element)
        _, size = _viewport(root, (100.0, 100.0))
        self.root = ElementTree.Element("svg", root.attrib)
        for style in [element for element in root.iter() if _tag(element) == "style"]:
            ElementTree.SubElement(self.root, "style").text = style.text
        self._add(root, self.root, size, ("", False), 1)

    def _add(self, element: Any, copy: Any, size: tuple[float, float], layer: tuple[str, bool], depth: int) -> None:
        """Add copies of the children of an element.

        Parameters
        ----------
        size : width and height of the viewport, to which percentages refer.
        layer : its name, and whether it is a layer of Inkscape, to which all groups in it belong.
        """
        if depth > MAX_DEPTH:
            raise DrawingError(f"has groups more than {MAX_DEPTH} deep, or an element that uses itself")
        for child in element:
            tag = _tag(child)
            if tag in _GROUPS or tag in _SHAPES:
                self._add_one(child, tag, copy, size, layer, depth)
            elif tag in _NAMES:
                self._left_out[_NAMES[tag]] += 1

    def _add_one(
        self, child: Any, tag: str, copy: Any, size: tuple[float, float], layer: tuple[str, bool], depth: int
    ) -> None:
        if next(self._count) > MAX_ELEMENTS:
            raise DrawingError(f"holds more than {MAX_ELEMENTS} elements, counted in all that uses them")
        attributes = dict(child.attrib)
        if re.search(r"clip-path:\s*url", f"{child.get('style', '')};clip-path:{child.get('clip-path', '')}"):
            self._left_out["clip path|s, whose lines are whole"] += 1
        for part, names in zip(size, _ALONG, strict=True):
            for name in names & attributes.keys():
                if (text := attributes[name].strip()).endswith("%"):
                    attributes[name] = repr(float(text[:-1]) / 100.0 * part)
        if tag in _SHAPES:
            ElementTree.SubElement(copy, tag, attributes | ({_LAYER: layer[0]} if layer[0] else {}))
            return
        inside: Any = child
        if tag == "g":
            name = child.get(f"{_INKSCAPE}label") or child.get("id") or layer[0]
            if child.get(f"{_INKSCAPE}groupmode") == "layer" or not layer[1]:
                layer = (name, layer[1] or child.get(f"{_INKSCAPE}groupmode") == "layer")
        elif tag in ("svg", "symbol"):
            placed, size = _viewport(child, size)
            attributes["transform"] = f"{attributes.get('transform', '')} {placed}"
        elif tag == "use":
            target = next((self._by_id.get(child.get(key)[1:]) for key in _HREF if child.get(key)), None)
            inside = [] if target is None else [target]
            x, y = (_length(child, name, "0", 0.0) for name in ("x", "y"))
            attributes["transform"] = f"{attributes.get('transform', '')} translate({x!r},{y!r})"
        if tag != "g":
            attributes = {name: value for name, value in attributes.items() if name not in _PLACEMENT}
        group = ElementTree.SubElement(copy, "g", attributes)
        if tag == "use" and inside and (used := _tag(inside[0])) in ("svg", "symbol"):
            sized = ElementTree.Element(inside[0].tag, inside[0].attrib)
            sized.attrib |= {key: value for key, value in child.attrib.items() if key in ("width", "height")}
            sized.extend(list(inside[0]))
            if depth > MAX_DEPTH:
                raise DrawingError(f"has groups more than {MAX_DEPTH} deep, or an element that uses itself")
            self._add_one(sized, used, group, size, layer, depth + 1)
        else:
            self._add(inside, group, size, layer, depth + 1)


def _tag(element: Any) -> str:
    return str(element.tag).removeprefix(_SVG)


def _length(element: Any, name: str, default: str, whole: float) -> float:
    import svgelements as svg

    return float(svg.Length(element.get(name, default)).value(ppi=96, relative_length=whole))


def _viewport(element: Any, size: tuple[float, float]) -> tuple[str, tuple[float, float]]:
    """The transform of a nested drawing or a symbol, and its size in its own unit."""
    import svgelements as svg

    x, y = (_length(element, name, "0", whole) for name, whole in zip("xy", size, strict=True))
    sides = [_length(element, name, "100%", whole) for name, whole in zip(("width", "height"), size, strict=True)]
    if (box := element.get("viewBox")) is None:
        return f"translate({x!r},{y!r})", (sides[0], sides[1])
    left, top, width, height = map(float, re.split(r"[\s,]+", box.strip()))
    placed = svg.Viewbox.viewbox_transform(x, y, *sides, left, top, width, height, element.get("preserveAspectRatio"))
    return str(placed), (width, height)


def _lines(
    drawing: Any, fills: bool, counted: Counter[str], curve: float, left_out: Counter[str]
) -> Iterator[FileLine]:
    import svgelements as svg

    left_out.update(counted)
    for shape, hidden in _shapes(drawing, ""):
        has_stroke = _is_seen(shape.stroke) and float(shape.stroke_width) > 0.0
        has_fill = _is_seen(shape.fill) and not isinstance(shape, svg.SimpleLine)
        if hidden or not (has_stroke or has_fill) or shape.values.get("visibility") in ("hidden", "collapse"):
            left_out[hidden or "hidden line|s"] += 1
            continue
        if not has_stroke and not fills:
            left_out["fill|s without a stroke"] += 1
            continue
        layer = str(shape.values.get(_LAYER) or (shape.stroke.hex if has_stroke else shape.fill.hex))
        name = str(shape.id or type(shape).__name__)
        # widths of the stroke after all transforms
        m = shape.transform
        matrix = checked(np.array([[m.a, m.c], [m.b, m.d]], dtype=float), layer, name)
        sizes = np.linalg.svd(matrix, compute_uv=False)
        unevenness = float(sizes[0] / max(sizes[1], 1e-12))
        is_even = unevenness <= 1.0 + _MAX_UNEVENNESS
        width = float(np.sqrt(sizes[0] * sizes[1]) * shape.stroke_width) if has_stroke and is_even else None
        for part in abs(svg.Path(shape)).as_subpaths():
            points = _points(svg.Path(part), curve, layer, name)
            if len(points) > 1:
                yield FileLine(points * [1.0, -1.0], layer, width, name, 1.0 if is_even else unevenness)


def _shapes(element: Any, hidden: str) -> Iterator[tuple[Any, str]]:
    """The shapes of a drawing, with the reason why they are hidden."""
    import svgelements as svg

    own = element.values.get("attributes", {})
    is_hidden = own.get("display", "").strip() == "none" or _is_zero(own.get("opacity"))
    if isinstance(element, svg.Shape):
        yield element, hidden or ("hidden line|s" if is_hidden else "")
    elif isinstance(element, svg.Group):
        for child in element:
            yield from _shapes(child, hidden or ("line|s in hidden layers" if is_hidden else ""))


def _is_seen(colour: Any) -> bool:
    return colour is not None and colour.value is not None and colour.alpha != 0


def _is_zero(text: str | None) -> bool:
    return text is not None and re.fullmatch(r"\s*[+-]?0*\.?0*%?\s*", text) is not None and "0" in text


def _points(part: Any, curve: float, layer: str, name: str) -> Floats:
    """(n, 2) points along one path."""
    import svgelements as svg

    def at(piece: Any, parameters: Floats) -> Floats:
        return checked(np.array([(p.x, p.y) for p in map(piece.point, parameters)], dtype=float), layer, name)

    pieces: list[Floats] = []
    for piece in part:
        if isinstance(piece, svg.Line | svg.Close):
            ends = [(p.x, p.y) for p in (piece.start, piece.end) if p is not None]
            pieces.append(checked(np.array(ends, dtype=float).reshape(-1, 2), layer, name))
        elif not isinstance(piece, svg.Move):
            pieces.append(flattened(partial(at, piece), np.linspace(0.0, 1.0, _CURVE_SAMPLES + 1), curve))
    return np.concatenate(pieces) if pieces else np.empty((0, 2))
