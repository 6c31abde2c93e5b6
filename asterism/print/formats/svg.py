"""SVG at 1:1: width and height in mm, a unit of one millimetre, and a group for each layer."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as xml

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.print.drawing import Circle, Drawing, DrawingLayer, Label, Polyline
from asterism.print.formats.registry import export_format


@export_format("SVG", ".svg", "drawing")
def write_svg(path: Path, drawing: Drawing) -> None:
    """Write a drawing; coordinates to a tenth of a micrometre."""
    width, height = (_number(side) for side in drawing.size_mm)
    size = {"width": f"{width}mm", "height": f"{height}mm", "viewBox": f"0 0 {width} {height}"}
    spaces = {"xmlns": "http://www.w3.org/2000/svg", "xmlns:inkscape": "http://www.inkscape.org/namespaces/inkscape"}
    root = xml.Element("svg", spaces | size)
    xml.SubElement(root, "title").text = drawing.title
    # y goes down from the upper left corner
    corner = np.array([drawing.low[0], drawing.high[1]])
    for layer in drawing.layers:
        group = xml.SubElement(root, "g", _layer(layer))
        for item in drawing.items:
            if item.layer == layer:
                _draw(group, item, corner)
    path.write_bytes(xml.tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n")


def _layer(layer: DrawingLayer) -> dict[str, str]:
    style = {
        "id": layer.name,
        "inkscape:label": layer.name,
        "inkscape:groupmode": "layer",
        "fill": layer.colour if layer.filled else "none",
        "fill-rule": "evenodd",
        "stroke": "none" if layer.filled else layer.colour,
        "stroke-width": _number(layer.width_mm),
    }
    if layer.dash_mm:
        style["stroke-dasharray"] = " ".join(map(_number, layer.dash_mm))
    return style


def _draw(group: xml.Element, item: Polyline | Circle | Label, corner: Floats) -> None:
    if isinstance(item, Polyline):
        rings = [_path(points, corner, item.closed) for points in (item.points, *item.holes)]
        xml.SubElement(group, "path", d=" ".join(rings))
    elif isinstance(item, Circle):
        x, y = _place(item.centre, corner)
        xml.SubElement(group, "circle", cx=x, cy=y, r=_number(item.radius_mm))
    else:
        x, y = _place(item.at, corner)
        text = xml.SubElement(group, "text", {"x": x, "y": y, "fill": item.layer.colour, "stroke": "none"})
        text.set("font-size", _number(item.size_mm))
        text.set("font-family", "monospace" if item.fixed_pitch else "sans-serif")
        text.set("font-weight", "bold" if item.bold else "normal")
        text.set("text-anchor", {"left": "start", "middle": "middle"}[item.end])
        text.text = item.text


def _path(points: Floats, corner: Floats, closed: bool) -> str:
    places = [",".join(_place(point, corner)) for point in points]
    return f"M{' L'.join(places)}" + (" Z" if closed else "")


def _place(point: Floats, corner: Floats) -> tuple[str, str]:
    return _number(point[0] - corner[0]), _number(corner[1] - point[1])


def _number(value: float) -> str:
    text = f"{value:.4f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
