"""The test print, its form and its table: the function behind `asterism strips new`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import shapely

from asterism.equilibrium.arrays import Floats, Ints
from asterism.measure.strips.form import csv_text, strip_form
from asterism.measure.strips.specimen import THICKNESSES_MM, PrintedStrip, Specimen, lay_out_specimen, layer_heights
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.rounding import Rounding
from asterism.pattern.design.stars import THICKNESS_RANGE_MM
from asterism.print.formats.pdf import write_pdf
from asterism.print.formats.stl import write_stl
from asterism.print.formats.threemf import write_3mf
from asterism.print.printer import Printer
from asterism.print.profiles import load_printer
from asterism.print.solid import Solid, Terrace, terraced_solid
from asterism.results.files import OutputError, staged

TEST_PRINT_FILES = ("start.gcode", "strips.3mf", "strips.csv", "strips.pdf", "strips.stl")


@dataclass(frozen=True)
class StripsPrint:
    """The files of a test print.

    Attributes
    ----------
    specimen : the strips on the bed.
    layers_mm : heights of the first layer and of the other layers.
    star_layers_mm : heights of the first layer and of the other layers that an export chooses first for stars.
    z_offset_mm : height of the fabric's surface above the bed.
    files : names of the files.
    """

    specimen: Specimen
    layers_mm: tuple[float, float]
    star_layers_mm: tuple[float, float]
    z_offset_mm: float
    files: tuple[str, ...] = TEST_PRINT_FILES


def new_strips(
    directory: str | Path,
    printer: str | Printer = "ultimaker2",
    *,
    thicknesses_mm: tuple[float, ...] = THICKNESSES_MM,
    count: int = 10,
    length_mm: float = 60.0,
    width_mm: float = 4.0,
    stretch: float = 1.35,
    fabric_thickness_mm: float = 0.8,
    stretched_thickness_mm: float | None = None,
    both_directions: bool = False,
) -> StripsPrint:
    """Write the files of a test print: strips as STL and 3MF, start code, instructions, and a table to fill in.

    Parameters
    ----------
    printer : a profile, its name, or its file.
    thicknesses_mm : thicknesses of the strips.
    count : strips of each thickness, and direction.
    length_mm, width_mm : size of each strip.
    stretch, fabric_thickness_mm : stretch of the fabric, and its thickness when released.
    stretched_thickness_mm : its thickness when stretched; by default that of the released fabric.

    both_directions : strips along the grain of the fabric, which lies along x, and as many across.

    Raises
    ------
    DesignError
        The strips do not fit on the bed, or a thickness is out of range or cannot be printed by the nozzle.
    OutputError
        The files cannot be written, or the directory holds a table that has been filled in.

    Examples
    --------
    >>> import tempfile
    >>> from asterism.measure.strips.new_strips import new_strips
    >>> written = new_strips(tempfile.mkdtemp(), "ultimaker2", count=2)
    >>> len(written.specimen.strips), written.layers_mm, written.z_offset_mm
    (8, (0.3, 0.05), 4.8)
    """
    directory = Path(directory)
    machine = load_printer(printer)
    for h in thicknesses_mm:
        if not THICKNESS_RANGE_MM[0] <= h <= THICKNESS_RANGE_MM[1]:
            raise DesignError(
                "--thickness", f"must be from {THICKNESS_RANGE_MM[0]:g} to {THICKNESS_RANGE_MM[1]:g} mm", h
            )
    if len(set(thicknesses_mm)) < len(thicknesses_mm):
        raise DesignError("--thickness", "must not be given twice", max(thicknesses_mm, key=thicknesses_mm.count))
    heights = layer_heights(thicknesses_mm, machine.nozzle_mm)
    specimen = lay_out_specimen(machine.bed_mm, thicknesses_mm, count, length_mm, width_mm, both_directions)
    table, text = directory / "strips.csv", csv_text(specimen, stretch, fabric_thickness_mm)
    if table.exists() and table.read_bytes() != text.encode():
        raise OutputError(f"{table} exists and may have been filled in; choose another directory with -o")
    rounding = Rounding(first_layer_mm=heights[0], layer_mm=heights[1], line_mm=machine.nozzle_mm)
    solids = [_solid(strip) for strip in specimen.strips]
    under_nozzle = fabric_thickness_mm if stretched_thickness_mm is None else stretched_thickness_mm
    z_offset = machine.frame.plate_mm + under_nozzle
    with staged(directory) as folder:
        write_3mf(folder / "strips.3mf", solids, "strips", rounding)
        write_stl(folder / "strips.stl", *_joined(solids))
        (folder / "strips.csv").write_text(text, encoding="utf-8", newline="\n")
        pages = strip_form(specimen, machine, under_nozzle, heights, stretch, fabric_thickness_mm)
        write_pdf(folder / "strips.pdf", pages)
        code = machine.start_snippet(z_offset, under_nozzle if stretched_thickness_mm is None else None)
        (folder / "start.gcode").write_text(code, encoding="utf-8", newline="\n")
    return StripsPrint(specimen, heights, (machine.first_layers_mm[0], machine.layer_mm), z_offset)


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
