"""Drawings at 1:1 in millimetres, with all items on named layers: DXF and SVG."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.pattern.drawing.dxf import DXF_NEEDED
from asterism.print.drawing import Circle, Drawing, DrawingLayer, Label, Polyline
from asterism.print.formats.registry import export_format

# the option for fixed dates belongs to the whole process
_DATES_LOCK = threading.Lock()


@export_format("DXF", ".dxf", "drawing", package="ezdxf", hint=DXF_NEEDED)
def write_dxf(path: Path, drawing: Drawing) -> None:
    """Write a drawing in the format of AutoCAD 2010; the same drawing is the same file, byte for byte."""
    from ezdxf import options  # type: ignore[attr-defined]

    with _DATES_LOCK:
        before = options.write_fixed_meta_data_for_testing
        # fixed dates and identifiers
        options.write_fixed_meta_data_for_testing = True
        try:
            _write(path, drawing)
        finally:
            options.write_fixed_meta_data_for_testing = before


def _write(path: Path, drawing: Drawing) -> None:
    from ezdxf import colors, units
    from ezdxf.enums import TextEntityAlignment
    from ezdxf.filemanagement import new

    ends = {"left": TextEntityAlignment.LEFT, "middle": TextEntityAlignment.CENTER}
    document = new("R2010", units=units.MM)
    document.header["$MEASUREMENT"] = 1
    document.header["$LUNITS"] = 2  # decimal
    document.header["$EXTMIN"] = (*drawing.low, 0.0)
    document.header["$EXTMAX"] = (*drawing.high, 0.0)
    layers = document.layers
    for layer in drawing.layers:
        # the layers 0 and Defpoints are in every file
        entry = layers.get(layer.name) if layers.has_entry(layer.name) else layers.add(layer.name)
        colour = colors.RGB.from_hex(layer.colour)
        if colour.luminance < 0.3:  # a dark one becomes the foreground colour, which is white on a black background
            entry.color = 7
        else:
            entry.rgb = colour
        if layer.dash_mm:
            pattern = [sum(layer.dash_mm), *(length * (-1) ** k for k, length in enumerate(layer.dash_mm))]
            document.linetypes.add(f"{layer.name}-dashed", pattern)
            entry.dxf.linetype = f"{layer.name}-dashed"
    space = document.modelspace()
    for item in drawing.items:
        on: dict[str, Any] = {"layer": item.layer.name}
        if isinstance(item, Polyline):
            if item.layer.is_printed_width:
                on["const_width"] = item.layer.width_mm
            for points in (item.points, *item.holes):
                space.add_lwpolyline(np.round(points, 6).tolist(), close=item.closed, dxfattribs=on)
        elif isinstance(item, Circle):
            space.add_circle(tuple(item.centre), item.radius_mm, dxfattribs=on)
        else:
            # height of capitals over the size of the font: DXF gives the height of capitals
            text = space.add_text(item.text, height=0.72 * item.size_mm, dxfattribs=on)
            text.set_placement((float(item.at[0]), float(item.at[1])), align=ends[item.end])
    # ezdxf adds the used classes in an order that changes from run to run
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)
    # the encoding of the format is UTF-8 on every system
    with path.open("w", encoding=document.output_encoding, errors="dxfreplace", newline="\n") as stream:
        document.write(stream)


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
