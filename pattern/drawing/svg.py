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
_NUMBER = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"
_SIZE = re.compile(rf"((?!-){_NUMBER}({'|'.join(_LENGTH_UNITS)}|px|%|em|ex)?)?")
_INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
_HREF = ("href", "{http://www.w3.org/1999/xlink}href")
_LAYER = "data-asterism-layer"
_SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")
_NAMES = {"text": "text|s", "image": "picture|s", "foreignObject": "foreign object|s"}
# percentages of these are of the height of the viewport, and of the others of its width
_UPWARDS = ("y", "height", "cy", "y1", "y2")
_PLACES = ("x", "width", "cx", "x1", "x2", *_UPWARDS)


def open_svg(path: Path, fills: bool) -> Source:
    """The drawing in an SVG file.

    `fills`: shapes that have a fill only are lines too.
    """
    import svgelements as svg  # slow to import, rarely used

    left_out: Counter[str] = Counter()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            root = ElementTree.fromstring(path.read_bytes())
            if _tag(root) != "svg":
                raise DrawingError("is not a drawing in SVG")
            texts = {side: "".join(root.get(side, "").split()).lower() for side in ("width", "height")}
            said = {side: text.removeprefix("auto") for side, text in texts.items()}
            if odd := next((text for text in said.values() if not _SIZE.fullmatch(text)), None):
                hint = "; decimals have a point" if "," in odd else ""
                raise DrawingError(f"has the size {odd!r}: must be a number and a unit, 120mm{hint}")
            root.attrib |= {side: text or "100%" for side, text in said.items()}
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
        self._by_id = {element.get("id"): element for element in reversed(list(root.iter()))}
        self.root = ElementTree.Element("svg", root.attrib)
        # svgelements uses a style from its place on
        self.root.extend(element for element in root.iter() if _tag(element) == "style")
        _, size = _viewport(root.attrib, (100.0, 100.0))
        for child in root:
            self._add(child, self.root, size, ("", False), 1)

    def _add(
        self,
        element: Any,
        parent: Any,
        size: tuple[float, float],
        layer: tuple[str, bool],
        depth: int,
        sides: dict[str, str] | None = None,
    ) -> None:
        """Add the copy of an element.

        Parameters
        ----------
        size : width and height of the viewport, to which percentages refer.
        layer : its name, and whether it is a layer of Inkscape, to which all groups in it belong.
        sides : width and height that the use of the element gives; None if it is not used.
        """
        tag, own = _tag(element), dict(element.attrib)
        if tag in _NAMES:
            self._left_out[_NAMES[tag]] += 1
        if tag not in ("g", "a", "switch", "svg", "use") and tag not in _SHAPES and (tag != "symbol" or sides is None):
            return
        if depth > MAX_DEPTH:
            raise DrawingError(f"has groups more than {MAX_DEPTH} deep, or an element that uses itself")
        if next(self._count) > MAX_ELEMENTS:
            raise DrawingError(f"holds more than {MAX_ELEMENTS} elements, counted in all that uses them")
        own |= {name: repr(_length(own, name, size[name in _UPWARDS])) for name in _PLACES if "%" in own.get(name, "")}
        if tag in _SHAPES:
            ElementTree.SubElement(parent, tag, own | ({_LAYER: layer[0]} if layer[0] else {}))
            return
        children, transform = list(element), own.get("transform", "")
        if tag == "g":
            name, is_layer = own.get(f"{_INKSCAPE}label") or own.get("id"), own.get(f"{_INKSCAPE}groupmode") == "layer"
            if is_layer or not layer[1]:
                layer = (name or layer[0], is_layer)
        elif tag in ("svg", "symbol"):
            placed, size = _viewport(own | (sides or {}), size)
            transform = f"{transform} {placed}"
        elif tag == "use":
            used = next((self._by_id.get(own[key][1:]) for key in _HREF if key in own), None)
            children = [] if used is None else [used]
            transform += f" translate({_length(own, 'x', size[0])!r},{_length(own, 'y', size[1])!r})"
        kept = {name: value for name, value in own.items() if name not in (*_PLACES, *_HREF, "viewBox")}
        group = ElementTree.SubElement(parent, "g", kept | {"transform": transform})
        given = (
            {side: own[side] for side in ("width", "height") if own.get(side, "auto") != "auto"}
            if tag == "use"
            else None
        )
        for child in children:
            self._add(child, group, size, layer, depth + 1, given)


def _tag(element: Any) -> str:
    return str(element.tag).removeprefix("{http://www.w3.org/2000/svg}")


def _length(own: dict[str, str], name: str, whole: float, default: str = "0") -> float:
    import svgelements as svg

    text = own.get(name, "auto")
    return float(svg.Length(default if text == "auto" else text).value(ppi=96, relative_length=whole))


def _viewport(own: dict[str, str], size: tuple[float, float]) -> tuple[str, tuple[float, float]]:
    """The transform of a nested drawing or a symbol, and its size in its own unit."""
    import svgelements as svg

    x, y = _length(own, "x", size[0]), _length(own, "y", size[1])
    width, height = _length(own, "width", size[0], "100%"), _length(own, "height", size[1], "100%")
    if "viewBox" not in own:
        return f"translate({x!r},{y!r})", (width, height)
    texts = re.split(r"[\s,]+", own["viewBox"].strip())
    box = [float(text) for text in texts if re.fullmatch(_NUMBER, text)]
    if len(box) != len(texts) or len(box) != 4 or min(box[2:]) <= 0.0:
        raise DrawingError(f"has the viewBox {own['viewBox']!r}: must be four numbers, the last two above 0")
    aspect = own.get("preserveAspectRatio")
    return str(svg.Viewbox.viewbox_transform(x, y, width, height, *box, aspect)), (box[2], box[3])


def _lines(
    drawing: Any, fills: bool, counted: Counter[str], curve: float, left_out: Counter[str]
) -> Iterator[FileLine]:
    import svgelements as svg

    left_out.update(counted)
    for shape, hidden in _shapes(drawing, "", left_out):
        has_stroke = _is_seen(shape.stroke) and not _is_zero(shape.values.get("stroke-width"))
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
        # a stroke is stretched unevenly if its widths along x and y differ by more than this part
        is_even = unevenness <= 1.02
        width = float(np.sqrt(sizes[0] * sizes[1]) * shape.stroke_width) if has_stroke and is_even else None
        for part in abs(svg.Path(shape)).as_subpaths():
            points = _points(svg.Path(part), curve, layer, name)
            if len(points) > 1:
                yield FileLine(points * [1.0, -1.0], layer, width, name, 1.0 if is_even else unevenness)


def _shapes(element: Any, hidden: str, left_out: Counter[str]) -> Iterator[tuple[Any, str]]:
    """The shapes of a drawing, with the reason why they are hidden; what cuts them is counted."""
    import svgelements as svg

    own = element.values.get("attributes", {})
    for cut in ("clip-path", "mask"):
        left_out[f"{cut.replace('-', ' ')}|s, whose lines are whole"] += "url" in own.get(cut, "")
    is_hidden = own.get("display", "").strip() == "none" or _is_zero(own.get("opacity"))
    if isinstance(element, svg.Shape):
        yield element, hidden or ("hidden line|s" if is_hidden else "")
    elif isinstance(element, svg.Group):
        for child in element:
            yield from _shapes(child, hidden or ("line|s in hidden layers" if is_hidden else ""), left_out)


def _is_seen(colour: Any) -> bool:
    return colour is not None and colour.value is not None and colour.alpha != 0


def _is_zero(text: str | None) -> bool:
    return text is not None and re.fullmatch(r"\s*[+-]?(0+\.?0*|\.0+)(%|[a-z]*)\s*", text) is not None


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
            # points of a curve at which its turn is measured
            pieces.append(flattened(partial(at, piece), np.linspace(0.0, 1.0, 65), curve))
    return np.concatenate(pieces) if pieces else np.empty((0, 2))
