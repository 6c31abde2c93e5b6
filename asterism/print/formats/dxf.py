"""DXF at 1:1: the header says millimetres, everything lies on named layers, texts too."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from asterism.print.drawing import Circle, Drawing, Polyline
from asterism.print.formats.registry import export_format

# DXF gives the height of capitals, other formats that of the font
_CAPITALS = 0.72
_DARK = 0.3
_ONE_AT_A_TIME = threading.Lock()


@export_format("DXF", ".dxf", "drawing")
def write_dxf(path: Path, drawing: Drawing) -> None:
    """Write a drawing in the format of AutoCAD 2010; the same drawing is the same file, byte for byte."""
    with _without_dates():
        _write(path, drawing)


@contextmanager
def _without_dates() -> Iterator[None]:
    """Fixed dates and identifiers in files of ezdxf, which has an option for all of a process only."""
    from ezdxf import options  # type: ignore[attr-defined]

    with _ONE_AT_A_TIME:
        before = options.write_fixed_meta_data_for_testing
        options.write_fixed_meta_data_for_testing = True
        try:
            yield
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
    for layer in drawing.layers:
        entry = document.layers.add(layer.name)
        colour = colors.RGB.from_hex(layer.colour)
        if colour.luminance < _DARK:
            # the foreground: white where the program draws on black
            entry.color = 7
        else:
            entry.rgb = colour
        if layer.dash_mm:
            pattern = [sum(layer.dash_mm), *(length * (-1) ** k for k, length in enumerate(layer.dash_mm))]
            document.linetypes.add(f"{layer.name}-dashed", pattern)
            entry.dxf.linetype = f"{layer.name}-dashed"
    space = document.modelspace()
    for item in drawing.items:
        on = {"layer": item.layer.name}
        if isinstance(item, Polyline):
            for points in (item.points, *item.holes):
                space.add_lwpolyline(np.round(points, 6).tolist(), close=item.closed, dxfattribs=on)
        elif isinstance(item, Circle):
            space.add_circle(tuple(item.centre), item.radius_mm, dxfattribs=on)
        else:
            text = space.add_text(item.text, height=_CAPITALS * item.size_mm, dxfattribs=on)
            text.set_placement((float(item.at[0]), float(item.at[1])), align=ends[item.end])
    # ezdxf adds the classes of what is used from a set, in the order of a hash that changes from run to run
    for name in sorted(document.entitydb.dxf_types_in_use()):
        document.classes.add_class(name)
    # through a stream of our own: the encoding of the format is UTF-8 on every system
    with path.open("w", encoding=document.output_encoding, errors="dxfreplace", newline="\n") as stream:
        document.write(stream)
