"""All files of an export, complete or not at all."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from asterism.print import instructions, sheets
from asterism.print.formats import dxf, glb, icesl, needle_table, obj, openscad, pdf, stl, svg, threemf
from asterism.print.job import Job
from asterism.print.rounded import better_layers, tiny_stars
from asterism.results.files import EXPORT as SUMMARY
from asterism.results.files import holds_result, staged
from asterism.results.vtu import write_rods_vtu, write_shape_vtu
from asterism.shape.shape import Shape
from pattern.design.design import save_design

# not summary.json: an export may go into the directory of a simulation
ROUNDED = "rounded.toml"
# files that not every export writes: those of an earlier one would be taken for this one's
NOT_ALWAYS = r"border\.stl|needles\.(csv|dxf|svg)|shape\.(obj|stl|glb)"
# these may be a simulation's
ALSO_RESULTS = r"|(shape|rods)\.vtu"


def write_export(job: Job, directory: str | Path, change: dict[str, Any] | None = None) -> dict[str, Any]:
    """Write everything for printing a job into a directory, all or none; returns what export.json says.

    Parameters
    ----------
    change : what rounding does to the shape, from `printed_shape`, if it was computed.

    Raises
    ------
    OutputError
        The files cannot be written there.
    """
    tiny = tiny_stars(job.plan, job.plastic.tiny_arm_mm)
    stale = None  # in a folder without an export everything is somebody's own
    if (Path(directory) / SUMMARY).is_file():
        stale = NOT_ALWAYS if holds_result(directory) else NOT_ALWAYS + ALSO_RESULTS
    with staged(directory, stale=stale) as folder:
        for solid in job.solids:
            stl.write(folder / f"{solid.name}.stl", solid.points, solid.triangles)
        threemf.write(folder / "print.3mf", job.solids, job.design.name)
        openscad.write(folder / "stars.scad", job)
        icesl.write(folder / "stars.lua", job)
        _write_sheets(job, folder)
        parts = instructions.chapters(job, job.cost, tiny)
        pdf.write(folder / "instructions.pdf", instructions.as_pages(job, parts))
        (folder / "instructions.txt").write_text(instructions.as_text(job, parts), encoding="utf-8", newline="\n")
        (folder / "start.gcode").write_text(job.start_code, encoding="utf-8", newline="\n")
        save_design(job.design, folder / ROUNDED)
        if job.shape is not None:
            write_shape_files(job.shape, job.design.name, folder)
        files = sorted([SUMMARY, *(file.name for file in folder.iterdir())])
        summary = _summary(job, tiny, change) | {"files": files}
        (folder / SUMMARY).write_text(json.dumps(summary, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    return summary


def write_shape_files(shape: Shape, name: str, folder: Path) -> None:
    """The sheet in space as OBJ, STL, GLB and VTU."""
    obj.write(folder / "shape.obj", shape.positions, shape.triangles)
    stl.write(folder / "shape.stl", shape.positions, shape.triangles)
    glb.write(folder / "shape.glb", shape, name)
    write_shape_vtu(shape, folder / "shape.vtu")
    if shape.rods:
        write_rods_vtu(shape, folder / "rods.vtu")


def _write_sheets(job: Job, folder: Path) -> None:
    layout, template = sheets.layout_sheet(job), sheets.needle_sheet(job)
    pages = [layout, sheets.stretch_sheet(job)]
    svg.write(folder / "layout.svg", layout)
    dxf.write(folder / "layout.dxf", layout)
    if template is not None:
        pages.append(template)
        svg.write(folder / "needles.svg", template)
        dxf.write(folder / "needles.dxf", template)
    if job.needles:
        needle_table.write(folder / "needles.csv", job.needles)
    pdf.write(folder / "layout.pdf", pages)


def _summary(job: Job, tiny: list[dict[str, Any]], change: dict[str, Any] | None) -> dict[str, Any]:
    better = better_layers(job.drawn_plan, job.rounding)
    return {
        "design": job.design.to_dict(),
        "printer": job.printer.model_dump(mode="json"),
        "plastic": job.plastic.model_dump(mode="json"),
        "stars": len(job.plan.centres),
        "rounding": job.rounding.model_dump(mode="json")
        | job.size_changes
        | {"better_layers": None if better is None else better.model_dump(mode="json")},
        "shape": None if job.shape is None else {"is_certain": job.is_certain, "warnings": job.shape_warnings},
        "shape_change": change,
        "tiny_stars": tiny,
        "solids": {solid.name: {"volume_mm3": solid.volume_mm3, "box_mm": solid.box.tolist()} for solid in job.solids},
        "printed_border": job.border is not None,
        "turn_deg": job.placement.turn_deg,
        "origin_on_bed_mm": [float(c) for c in job.placement.shift + job.printer.bed_centre_mm],
        "z_offset_mm": job.z_offset_mm,
        "fabric_given": job.fabric_given,
        "check_square_mm": {"before": [job.check_before_mm] * 2, "after": list(job.check_after_mm)},
        "needles": len(job.needles),
        "needles_in_plastic": job.needles_in_plastic,
        "hangs_below_base_mm": job.hangs_mm,
        "hangs_doubt_mm": job.hangs_doubt_mm,
        "estimate": job.cost,
    }
