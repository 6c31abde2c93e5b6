"""`asterism strips new`: the test print and the sheets that go with it."""

from __future__ import annotations

from pathlib import Path
from shlex import quote

import numpy as np
import shapely

from asterism.measure.strips.form import PrintStart, csv_text, strip_form
from asterism.measure.strips.specimen import PrintedStrip, Specimen, lay_out_specimen, layer_heights
from asterism.print.formats import pdf, stl, threemf
from asterism.print.printer import Printer
from asterism.print.solid import Solid, Terrace, terraced_solid
from asterism.results.files import OutputError, staged
from pattern.design.errors import DesignError
from pattern.design.stars import THICKNESS_MM
from pattern.geometry.arrays import Floats, Ints

FILES = ("start.gcode", "strips.3mf", "strips.csv", "strips.pdf", "strips.stl")


def new_strips(
    directory: Path,
    printer: Printer,
    thicknesses_mm: tuple[float, ...],
    count: int,
    length_mm: float,
    width_mm: float,
    stretch: float,
    fabric_mm: float,
    stretched_mm: float | None = None,
) -> list[str]:
    """Write the files of a test print; returns the lines to print.

    `fabric_mm` is the thickness of the released fabric, `stretched_mm` that of the stretched one, if it is known.

    Raises
    ------
    DesignError
        The strips do not fit on the bed, or a thickness is out of range or not one of the nozzle.
    OutputError
        The files cannot be written, or a table is there that has been filled in.
    """
    bed = printer.bed_mm
    for h in thicknesses_mm:
        if not THICKNESS_MM[0] <= h <= THICKNESS_MM[1]:
            raise DesignError("--thickness", f"must be from {THICKNESS_MM[0]:g} to {THICKNESS_MM[1]:g} mm", h)
    if len(set(thicknesses_mm)) < len(thicknesses_mm):
        raise DesignError("--thickness", "must not be given twice", max(thicknesses_mm, key=thicknesses_mm.count))
    heights = layer_heights(thicknesses_mm, printer.nozzle_mm)
    strips = lay_out_specimen(bed, thicknesses_mm, count, length_mm, width_mm)
    table, text = directory / "strips.csv", csv_text(strips, stretch, fabric_mm)
    if table.exists() and table.read_bytes() != text.encode():
        raise OutputError(f"{table} exists and may have been filled in; choose another directory with -o")
    solids = [_solid(strip, strips) for strip in strips.strips]
    with staged(directory) as folder:
        threemf.write(folder / "strips.3mf", solids, "strips")
        stl.write(folder / "strips.stl", *_joined(solids))
        (folder / "strips.csv").write_text(text, encoding="utf-8", newline="\n")
        start = PrintStart(printer, fabric_mm if stretched_mm is None else stretched_mm)
        pdf.write(folder / "strips.pdf", strip_form(strips, start, heights, stretch, fabric_mm))
        code = printer.start_snippet(start.z_offset_mm, fabric_mm if stretched_mm is None else None)
        (folder / "start.gcode").write_text(code, encoding="utf-8", newline="\n")
    fabric = "released" if stretched_mm is None else "stretched"
    thick = ", ".join(f"{h:g}" for h in strips.thicknesses_mm)
    return [
        f"  {len(strips.strips)} strips of {length_mm:g} x {width_mm:g} mm, {thick} mm thick",
        f"  slice with a first layer of {heights[0]:g} mm and others of {heights[1]:g} mm",
        f"  z offset {start.z_offset_mm:.2f} mm (plate and {fabric} fabric), in start.gcode",
        f"{directory}: {', '.join(FILES)}; measure, fill in the table, then  asterism strips fit {quote(str(table))}",
    ]


def _joined(solids: list[Solid]) -> tuple[Floats, Ints]:
    """Points and triangles of all."""
    before = np.cumsum([0, *(len(solid.points) for solid in solids[:-1])])
    triangles = [solid.triangles + first for solid, first in zip(solids, before, strict=True)]
    return np.concatenate([solid.points for solid in solids]), np.concatenate(triangles)


def _solid(strip: PrintedStrip, specimen: Specimen) -> Solid:
    """A strip as a box with its name, about the middle of the bed."""
    (x, y), half = strip.centre_mm, (specimen.length_mm / 2, specimen.width_mm / 2)
    region = shapely.box(x - half[0], y - half[1], x + half[0], y + half[1])
    return terraced_solid(f"strip {strip.number}, {strip.thickness_mm:g} mm", [Terrace(strip.thickness_mm, region)])
