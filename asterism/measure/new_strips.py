"""The test print, its form and its table: the function behind `asterism strips new`."""

from __future__ import annotations

import math
import textwrap
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import shapely

from asterism.draw.style import BLUE, RED
from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.strip_table import BOX_COLUMNS, DIRECTION_COLUMN, KNOWN_COLUMNS, Direction, arc_box
from asterism.pattern.design.errors import DesignError, check_type
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.design.stars import THICKNESS_RANGE_MM
from asterism.print.drawing import A4_MM, TEXT, Drawing, DrawingLayer, Label, Polyline, rectangle
from asterism.print.formats.meshes import write_stl
from asterism.print.formats.pdf import write_pdf
from asterism.print.formats.threemf import write_3mf
from asterism.print.instructions import homing_advice
from asterism.print.printer import Printer, adjusted_printer
from asterism.print.rounding import MAX_LAYER_OVER_LINE
from asterism.print.solid import Solid, Terrace, terraced_solid
from asterism.process.settings import ExportSettings, StripPrintSettings
from asterism.results.files import OutputError, staged

# gap between strips: space for scissors
STRIP_GAP_MM = 8.0
BED_MARGIN_MM = 5.0


@dataclass(frozen=True)
class PrintedStrip:
    """A strip of plastic."""

    number: int  # from 1, row by row from the lower left
    thickness_mm: float
    centre_mm: tuple[float, float]  # centre, from the middle of the bed
    size_mm: tuple[float, float]  # along x and y
    # to the grain of the fabric, which lies along x; None if the print has one direction
    direction: Direction | None = None


@dataclass(frozen=True)
class StripsPrint:
    """A test print, of which the command has written the files."""

    settings: StripPrintSettings
    printer: Printer  # the printer with the plate of the settings
    strips: tuple[PrintedStrip, ...]  # the strips on the bed; all along x, or some along x and the others along y
    layers_mm: tuple[float, float]  # heights of the first layer and of the other layers
    # names of the files
    files: tuple[str, ...] = ("start.gcode", "strips.3mf", "strips.csv", "strips.pdf", "strips.stl")

    @property
    def thicknesses_mm(self) -> tuple[float, ...]:
        """The thicknesses, the smallest first."""
        return tuple(sorted(self.settings.thicknesses_mm))

    @property
    def under_nozzle_mm(self) -> float:
        """Thickness of the stretched fabric, or of the released one if that is not known."""
        return self.settings.fabric_mm or self.settings.fabric_thickness_mm

    @property
    def z_offset_mm(self) -> float:
        """Height of the fabric's surface above the bed."""
        return self.printer.frame.plate_mm + self.under_nozzle_mm


def lay_out_strips(bed_mm: tuple[float, float], settings: StripPrintSettings) -> tuple[PrintedStrip, ...]:
    """Lay out the strips of each thickness on a bed, along x; or as many along x and above them along y.

    The thicknesses alternate, so that an uneven bed affects all of them equally. DesignError if they do not fit.
    """
    thicknesses_mm, both, length_mm = settings.thicknesses_mm, settings.both_directions, settings.length_mm
    count = settings.count or (5 if both else 10)
    total, room = count * len(thicknesses_mm), [side - 2 * BED_MARGIN_MM for side in bed_mm]
    size = (length_mm, 4.0)
    blocks: list[tuple[Direction | None, tuple[float, float]]]
    blocks = [("along", size), ("across", size[::-1])] if both else [(None, size)]
    given = f"{total * len(blocks)} strips of {length_mm:g} mm"
    fits = f"must fit on the bed of {bed_mm[0]:g} x {bed_mm[1]:g} mm: "
    strips: list[PrintedStrip] = []
    top = 0.0
    for direction, (x, y) in blocks:
        columns = min(math.floor((room[0] + STRIP_GAP_MM) / (x + STRIP_GAP_MM)), total)
        if columns < 1:
            raise DesignError("--length", f"{fits}it has room for {room[0]:g} mm", given)
        for place in range(total):
            row, column = divmod(place, columns)
            # shift the sequence if each column would hold one thickness
            turn = row if columns % len(thicknesses_mm) == 0 else 0
            thickness = thicknesses_mm[(place + turn) % len(thicknesses_mm)]
            centre = ((column - (columns - 1) / 2) * (x + STRIP_GAP_MM), top + row * (y + STRIP_GAP_MM) + y / 2)
            strips.append(PrintedStrip(len(strips) + 1, thickness, centre, (x, y), direction))
        top += math.ceil(total / columns) * (y + STRIP_GAP_MM)
    height = top - STRIP_GAP_MM
    if height > room[1]:
        raise DesignError("--count", f"{fits}they need {height:g} of {room[1]:g} mm", given)
    return tuple(replace(each, centre_mm=(each.centre_mm[0], each.centre_mm[1] - height / 2)) for each in strips)


def layer_heights(thicknesses_mm: tuple[float, ...], nozzle_mm: float) -> tuple[float, float]:
    """Largest heights (mm) of the first and of the other layers that give all thicknesses exactly, or DesignError."""
    heights = sorted(round(1000 * h) for h in thicknesses_mm)
    most = round(1000 * MAX_LAYER_OVER_LINE * nozzle_mm)
    in_one = heights[0] <= most
    step = math.gcd(*(h - heights[0] * in_one for h in heights)) or heights[0]
    others = next(step // parts for parts in range(1, step + 1) if step % parts == 0 and step // parts <= most)
    first = heights[0] if in_one else others
    if min(first, others) < (least := 40):  # the thinnest layer of common printers
        which = f"{least / 1000:g} to {most / 1000:g} mm (nozzle {nozzle_mm:g} mm)"
        problem = f"must be a first layer and equal others, of {which}"
        raise DesignError("--thickness", problem, ", ".join(f"{h:g}" for h in sorted(thicknesses_mm)))
    return first / 1000, others / 1000


# pen of the form for frames, rules and notes
HELP_PEN = DrawingLayer("help", "#7a7a82", 0.15)


def strip_form(new: StripsPrint) -> tuple[Drawing, ...]:
    """Pages of A4: the instructions with the map, and the table with 40 strips a page."""
    settings, printer = new.settings, new.printer
    stretch, fabric_mm, under_nozzle_mm = settings.stretch, settings.fabric_thickness_mm, new.under_nozzle_mm
    first, others = new.layers_mm
    plate_mm = printer.frame.plate_mm
    expected = rest_curvature(new.thicknesses_mm, Fabric(stretch=stretch, thickness_mm=fabric_mm), Plastic())
    heights = arc_box(expected, settings.length_mm)[1]
    thicknesses = ", ".join(f"{h:g}" for h in new.thicknesses_mm)
    lines = [
        f"1. Stretch the fabric: a square of 10 cm drawn on it must then measure {10 * stretch:g} cm. If it does not,",
        "    write your own stretch into the table. Measure the fabric's thickness before it is stretched:",
        f"    the table says {fabric_mm:g} mm.",
        *(["    The fabric's grain lies from left to right."] if settings.both_directions else []),
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
    items, y = page_head("Strips to measure a plastic and a fabric", lines)
    items += _boxes(np.array([15.0, y - 34.0]))
    items += _map(new)
    tables = [_table_page(new, new.strips[i : i + 40]) for i in range(0, len(new.strips), 40)]
    return (Drawing("Strips", np.zeros(2), np.array(A4_MM), tuple(items)), *tables)


def page_head(title: str, lines: list[str]) -> tuple[list[Polyline | Label], float]:
    """The title and the instructions of a page of A4, and the height below them (mm)."""
    items: list[Polyline | Label] = [Label(TEXT, np.array([15.0, 278.0]), title, 6.0, bold=True)]
    items += [Label(TEXT, np.array([15.0, 268.0 - 5.0 * k]), line, 3.0) for k, line in enumerate(lines)]
    return items, 268.0 - 5.0 * len(lines)


def csv_text(new: StripsPrint) -> str:
    """The table to fill in as CSV, with the known values."""
    settings = new.settings
    direction = [DIRECTION_COLUMN] if settings.both_directions else []
    lines = [",".join((*KNOWN_COLUMNS, *direction, *BOX_COLUMNS))]
    fabric = settings.length_mm, settings.stretch, settings.fabric_thickness_mm
    for strip in new.strips:
        known = [str(strip.number), *(f"{x:g}" for x in (strip.thickness_mm, *fabric))]
        known += [strip.direction] if strip.direction else []
        lines.append(",".join([*known, *[""] * len(BOX_COLUMNS)]))
    return "\n".join(lines) + "\n"


def _map(new: StripsPrint) -> list[Polyline | Label]:
    """The strips on the bed at the foot of the page, in a round scale."""
    bed_mm = new.printer.bed_mm
    scales = (1, 2, 2.5, 3, 4, 5, 10, 20, 50)
    # largest size of the map of the strips
    parts = next(n for n in scales if all(bed <= n * room for bed, room in zip(bed_mm, (180.0, 115.0), strict=True)))
    width, depth = bed_mm[0] / parts, bed_mm[1] / parts
    centre = (A4_MM[0] / 2, 12.0 + depth / 2)
    grain = ", grain from left to right" if new.settings.both_directions else ""
    head = f"The print, 1:{parts:g}, seen from above: number and thickness{grain}"
    items: list[Polyline | Label] = [
        Label(HELP_PEN, np.array([15.0, 14.5 + depth]), head, 3.0),
        rectangle(HELP_PEN, (width, depth), centre),
    ]
    pen = DrawingLayer("strips", "#26262b", 0.2, filled=True)
    for strip in new.strips:
        size = (strip.size_mm[0] / parts, strip.size_mm[1] / parts)
        x, y = centre[0] + strip.centre_mm[0] / parts, centre[1] + strip.centre_mm[1] / parts
        items.append(rectangle(pen, size, (x, y)))
        is_upright = size[1] > size[0]  # and without space for its thickness
        label = str(strip.number) if is_upright else f"{strip.number}: {strip.thickness_mm:g}"
        items.append(Label(TEXT, np.array([x, y + size[1] / 2 + 0.6]), label, 2.3, end="middle"))
    return items


def wrapped(step: str) -> list[str]:
    """One step, wrapped into lines of the page."""
    return textwrap.wrap(step, 108, subsequent_indent="    ")


def _boxes(corner: Floats) -> list[Polyline | Label]:
    """Three examples of arcs in their boxes."""
    arc_pen, box_pen = DrawingLayer("arcs", BLUE, 0.8), DrawingLayer("boxes", RED, 0.25, (1.5, 1.0))
    items: list[Polyline | Label] = []
    for column, (angle, name) in enumerate(((1.6, "up to half a circle"), (np.pi, "half a circle"), (4.4, "beyond"))):
        length = 42.0
        radius = length / angle
        turn = np.linspace(-angle / 2, angle / 2, 60)
        line = radius * np.column_stack([np.sin(turn), np.cos(turn) - np.cos(angle / 2)])
        width, height = (float(side) for side in arc_box(1 / radius, length))
        middle = corner + np.array([30.0 + 60.0 * column, 6.0])
        items.append(Polyline(arc_pen, middle + line))
        items.append(rectangle(box_pen, (width, height), (float(middle[0]), float(middle[1] + height / 2))))
        items.append(Label(HELP_PEN, middle - [0.0, 3.2], f"width {width:.0f}, height {height:.0f}", 2.6, end="middle"))
        items.append(Label(HELP_PEN, middle - [0.0, 6.6], name, 2.6, end="middle"))
    return items


def _table_page(new: StripsPrint, strips: tuple[PrintedStrip, ...]) -> Drawing:
    edges = np.array([15.0, 30.0, 50.0, 86.0, 122.0, 158.0, 195.0])
    middles = (edges[:-1] + edges[1:]) / 2
    heads = ("strip", "thickness", "width", "height", "width", "height")
    units = ("", "mm", "with fabric", "with fabric", "peeled", "peeled")
    top, pitch = 280.0, 6.3
    items: list[Polyline | Label] = []
    for name, below, x in zip(heads, units, middles, strict=True):
        items.append(Label(TEXT, np.array([x, top - 4.0]), name, 3.0, end="middle", bold=True))
        items.append(Label(HELP_PEN, np.array([x, top - 7.6]), below, 2.6, end="middle"))
    for row in range(len(strips) + 1):
        y = top - 10.0 - pitch * row
        items.append(Polyline(HELP_PEN, np.array([[edges[0], y], [edges[-1], y]])))
        if row < len(strips):
            for text, x in zip((str(strips[row].number), f"{strips[row].thickness_mm:g}"), middles, strict=False):
                items.append(Label(TEXT, np.array([x, y - pitch + 1.9]), text, 3.0, end="middle"))
    bottom = top - 10.0 - pitch * len(strips)
    items += [Polyline(HELP_PEN, np.array([[x, top], [x, bottom]])) for x in edges]
    note = f"Boxes in mm; strips {new.settings.length_mm:g} mm long. Type them into strips.csv."
    items.append(Label(HELP_PEN, np.array([15.0, 285.0]), note, 3.0))
    return Drawing("Strips", np.zeros(2), np.array(A4_MM), tuple(items))


def new_strips(directory: str | Path, settings: StripPrintSettings | None = None) -> StripsPrint:
    """Write the files of a test print: strips as STL and 3MF, start code, instructions, and a table to fill in.

    Raises
    ------
    DesignError
        The strips do not fit on the bed, or a thickness is out of range or cannot be printed by the nozzle.
    OutputError
        The files cannot be written, or the directory holds a table that has been filled in.

    Examples
    --------
    >>> import tempfile
    >>> from asterism.measure.new_strips import StripPrintSettings, new_strips
    >>> written = new_strips(tempfile.mkdtemp(), StripPrintSettings(count=2))
    >>> len(written.strips), written.layers_mm, written.z_offset_mm
    (8, (0.3, 0.05), 4.8)
    """
    directory, settings = Path(directory), StripPrintSettings() if settings is None else settings
    check_type(settings, StripPrintSettings, "StripPrintSettings(count=5) is an example")
    machine = adjusted_printer(ExportSettings(printer=settings.printer, plate_mm=settings.plate_mm))
    low, high = THICKNESS_RANGE_MM
    for h in settings.thicknesses_mm:
        if not low <= h <= high:
            raise DesignError("--thickness", f"must be from {low:g} to {high:g} mm", h)
        if settings.thicknesses_mm.count(h) > 1:
            raise DesignError("--thickness", "must not be given twice", h)
    layers = layer_heights(settings.thicknesses_mm, machine.nozzle_mm)
    new = StripsPrint(settings, machine, lay_out_strips(machine.bed_mm, settings), layers)
    table, text = directory / "strips.csv", csv_text(new)
    if table.exists() and table.read_bytes() != text.encode():
        raise OutputError(f"{table} exists and may have been filled in; choose another directory with -o")
    rounding = Rounding(first_layer_mm=layers[0], layer_mm=layers[1], line_mm=machine.nozzle_mm)
    solids = [_solid(strip) for strip in new.strips]
    with staged(directory) as folder:
        write_3mf(folder / "strips.3mf", solids, "strips", rounding)
        write_stl(folder / "strips.stl", *_joined(solids))
        (folder / "strips.csv").write_text(text, encoding="utf-8", newline="\n")
        write_pdf(folder / "strips.pdf", strip_form(new))
        code = machine.start_snippet(new.z_offset_mm, new.under_nozzle_mm if settings.fabric_mm is None else None)
        (folder / "start.gcode").write_text(code, encoding="utf-8", newline="\n")
    return new


def _joined(solids: list[Solid]) -> tuple[Floats, Ints]:
    """Points and triangles of all solids in one mesh."""
    before = np.cumsum([0, *(len(solid.points) for solid in solids[:-1])])
    triangles = [solid.triangles + first for solid, first in zip(solids, before, strict=True)]
    return np.concatenate([solid.points for solid in solids]), np.concatenate(triangles)


def _solid(strip: PrintedStrip) -> Solid:
    """A strip as a named box, in coordinates from the middle of the bed."""
    (x, y), half = strip.centre_mm, [side / 2 for side in strip.size_mm]
    region = shapely.box(x - half[0], y - half[1], x + half[0], y + half[1])
    return terraced_solid(f"strip {strip.number}, {strip.thickness_mm:g} mm", [Terrace(strip.thickness_mm, region)])
