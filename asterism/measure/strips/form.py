"""The form of the test print: a map of the strips, instructions, and a table to fill in."""

from __future__ import annotations

import textwrap

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.measure.strips import arc
from asterism.measure.strips.specimen import PrintedStrip, Specimen
from asterism.measure.strips.strip_table import BOX_COLUMNS, DIRECTION_COLUMN, KNOWN_COLUMNS
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature
from asterism.print.drawing import A4_MM, Drawing, DrawingLayer, Label, Polyline, rectangle
from asterism.print.instructions import homing_advice
from asterism.print.printer import Printer

# largest size of the map of the strips
MAP_MM = (180.0, 115.0)
# pens of the form: text and numbers
TEXT_PEN = DrawingLayer("text", "#26262b", 0.2)
# frames, rules and notes
HELP_PEN = DrawingLayer("help", "#7a7a82", 0.15)
# the printed strips on the map
STRIP_PEN = DrawingLayer("strips", "#26262b", 0.2, filled=True)
# the box around a curled strip
BOX_PEN = DrawingLayer("boxes", "#c8553d", 0.25, dash_mm=(1.5, 1.0))
# the curled strip, seen from its edge
ARC_PEN = DrawingLayer("arcs", "#2a6f97", 0.8)

Pair = tuple[float, float]


def strip_form(
    specimen: Specimen, printer: Printer, under_nozzle_mm: float, layers_mm: Pair, stretch: float, fabric_mm: float
) -> tuple[Drawing, ...]:
    """Pages of A4: the map with the instructions, and the table with 40 strips a page.

    Parameters
    ----------
    under_nozzle_mm : thickness of the stretched fabric.
    layers_mm : heights of the first layer and of the other layers.
    stretch, fabric_mm : stretch of the fabric, and its thickness when released.
    """
    lines = _instructions(specimen, printer, under_nozzle_mm, layers_mm, stretch, fabric_mm)
    items, y = page_head("Strips to measure a plastic and a fabric", lines)
    items += _boxes(np.array([15.0, y - 34.0]))
    items += _map(specimen, printer.bed_mm)
    tables = [_table_page(specimen, specimen.strips[i : i + 40]) for i in range(0, len(specimen.strips), 40)]
    return (Drawing("Strips", np.zeros(2), np.array(A4_MM), tuple(items)), *tables)


def page_head(title: str, lines: list[str]) -> tuple[list[Polyline | Label], float]:
    """The title and the instructions of a page of A4, and the height below them (mm)."""
    items: list[Polyline | Label] = [Label(TEXT_PEN, np.array([15.0, 278.0]), title, 6.0, bold=True)]
    items += [Label(TEXT_PEN, np.array([15.0, 268.0 - 5.0 * k]), line, 3.0) for k, line in enumerate(lines)]
    return items, 268.0 - 5.0 * len(lines)


def csv_text(specimen: Specimen, stretch: float, fabric_mm: float) -> str:
    """The table to fill in as CSV, with the known values."""
    direction = [DIRECTION_COLUMN] if specimen.has_directions else []
    lines = [",".join((*KNOWN_COLUMNS, *direction, *BOX_COLUMNS))]
    for strip in specimen.strips:
        known = [str(strip.number), *(f"{x:g}" for x in (strip.thickness_mm, specimen.length_mm, stretch, fabric_mm))]
        known += [strip.direction] if strip.direction else []
        lines.append(",".join([*known, *[""] * len(BOX_COLUMNS)]))
    return "\n".join(lines) + "\n"


def _map(specimen: Specimen, bed_mm: tuple[float, float]) -> list[Polyline | Label]:
    """The strips on the bed at the foot of the page, in a round scale."""
    scales = (1, 2, 2.5, 3, 4, 5, 10, 20, 50)
    parts = next(n for n in scales if all(bed <= n * room for bed, room in zip(bed_mm, MAP_MM, strict=True)))
    width, depth = bed_mm[0] / parts, bed_mm[1] / parts
    centre = (A4_MM[0] / 2, 12.0 + depth / 2)
    grain = ", grain from left to right" if specimen.has_directions else ""
    head = f"The print, 1:{parts:g}, seen from above: number and thickness{grain}"
    items: list[Polyline | Label] = [
        Label(HELP_PEN, np.array([15.0, 14.5 + depth]), head, 3.0),
        rectangle(HELP_PEN, (width, depth), centre),
    ]
    for strip in specimen.strips:
        size = (strip.size_mm[0] / parts, strip.size_mm[1] / parts)
        x, y = centre[0] + strip.centre_mm[0] / parts, centre[1] + strip.centre_mm[1] / parts
        items.append(rectangle(STRIP_PEN, size, (x, y)))
        is_upright = size[1] > size[0]  # and without space for its thickness
        label = str(strip.number) if is_upright else f"{strip.number}: {strip.thickness_mm:g}"
        items.append(Label(TEXT_PEN, np.array([x, y + size[1] / 2 + 0.6]), label, 2.3, end="middle"))
    return items


def _instructions(
    specimen: Specimen, printer: Printer, under_nozzle_mm: float, layers_mm: Pair, stretch: float, fabric_mm: float
) -> list[str]:
    """The instructions, line by line."""
    first, others = layers_mm
    plate_mm = printer.frame.plate_mm
    expected = rest_curvature(specimen.thicknesses_mm, Fabric(stretch=stretch, thickness_mm=fabric_mm), Plastic())
    heights = arc.box(expected, specimen.length_mm)[1]
    thicknesses = ", ".join(f"{h:g}" for h in specimen.thicknesses_mm)
    return [
        f"1. Stretch the fabric: a square of 10 cm drawn on it must then measure {10 * stretch:g} cm. If it does not,",
        "    write your own stretch into the table. Measure the fabric's thickness before it is stretched:",
        f"    the table says {fabric_mm:g} mm.",
        *(["    The fabric's grain lies from left to right."] if specimen.has_directions else []),
        *wrapped(f"2. Put the frame with its plate on the bed. {homing_advice(printer)}"),
        *wrapped(
            "3. Add start.gcode to the end of the printer's start code and leave the slicer's z offset at 0: the "
            f"nozzle starts {plate_mm + under_nozzle_mm:.2f} mm above the bed, plate {plate_mm:.2f} mm and "
            f"fabric {under_nozzle_mm:.2f} mm. Measure both on the bed; if they differ, --plate and --fabric."
        ),
        f"4. Slice strips.3mf with a first layer of {first:g} mm and others of {others:g} mm, lines along strips.",
        f"    They are {thicknesses} mm thick; measure some with a caliper and correct the table: 0.01 mm matters.",
        "5. Write each strip's number on its back, release the fabric, and cut it off along the strips.",
        "6. Lay each strip on its long edge, so that its weight does not bend it; photograph from above with a ruler.",
        f"    With the paper's plastic, arcs would be {heights[-1]:.1f} to {heights[0]:.1f} mm high.",
        "7. Draw a box around the line between plastic and fabric, one side through its two ends (below).",
        "    Write down its width and height in mm. If the box holds the strip's thickness, too: fit with --outside.",
        "    A strip that looks straight has the height flat.",
        "8. Peel the fabric off, measure once more. If a peeled strip bends to the other side, see the page on strips.",
        "9. asterism strips fit strips.csv",
    ]


def wrapped(step: str) -> list[str]:
    """One step, wrapped into lines of the page."""
    return textwrap.wrap(step, 108, subsequent_indent="    ")


def _boxes(corner: Floats) -> list[Polyline | Label]:
    """Three examples of arcs in their boxes."""
    items: list[Polyline | Label] = []
    for column, (angle, name) in enumerate(((1.6, "up to half a circle"), (np.pi, "half a circle"), (4.4, "beyond"))):
        length = 42.0
        radius = length / angle
        turn = np.linspace(-angle / 2, angle / 2, 60)
        line = radius * np.column_stack([np.sin(turn), np.cos(turn) - np.cos(angle / 2)])
        width, height = (float(side) for side in arc.box(1 / radius, length))
        middle = corner + np.array([30.0 + 60.0 * column, 6.0])
        items.append(Polyline(ARC_PEN, middle + line))
        items.append(rectangle(BOX_PEN, (width, height), (float(middle[0]), float(middle[1] + height / 2))))
        items.append(Label(HELP_PEN, middle - [0.0, 3.2], f"width {width:.0f}, height {height:.0f}", 2.6, end="middle"))
        items.append(Label(HELP_PEN, middle - [0.0, 6.6], name, 2.6, end="middle"))
    return items


def _table_page(specimen: Specimen, strips: tuple[PrintedStrip, ...]) -> Drawing:
    edges = np.array([15.0, 30.0, 50.0, 86.0, 122.0, 158.0, 195.0])
    heads = [
        ("strip", ""),
        ("thickness", "mm"),
        ("width", "with fabric"),
        ("height", "with fabric"),
        ("width", "peeled"),
        ("height", "peeled"),
    ]
    top, pitch = 280.0, 6.3
    items: list[Polyline | Label] = []
    for (name, below), left, right in zip(heads, edges[:-1], edges[1:], strict=True):
        items.append(Label(TEXT_PEN, np.array([(left + right) / 2, top - 4.0]), name, 3.0, end="middle", bold=True))
        items.append(Label(HELP_PEN, np.array([(left + right) / 2, top - 7.6]), below, 2.6, end="middle"))
    for row in range(len(strips) + 1):
        y = top - 10.0 - pitch * row
        items.append(Polyline(HELP_PEN, np.array([[edges[0], y], [edges[-1], y]])))
        if row < len(strips):
            for text, left, right in (
                (str(strips[row].number), 15.0, 30.0),
                (f"{strips[row].thickness_mm:g}", 30.0, 50.0),
            ):
                items.append(Label(TEXT_PEN, np.array([(left + right) / 2, y - pitch + 1.9]), text, 3.0, end="middle"))
    bottom = top - 10.0 - pitch * len(strips)
    items += [Polyline(HELP_PEN, np.array([[x, top], [x, bottom]])) for x in edges]
    note = f"Boxes in mm; strips {specimen.length_mm:g} mm long. Type them into strips.csv."
    items.append(Label(HELP_PEN, np.array([15.0, 285.0]), note, 3.0))
    return Drawing("Strips", np.zeros(2), np.array(A4_MM), tuple(items))
