"""Writes all files of an export, complete or not at all."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from asterism.pattern.design.design import save_design
from asterism.print import instructions, sheets
from asterism.print.drawing import RODS, Drawing, DrawingLayer, Polyline
from asterism.print.formats.registry import ExportFormat, FormatKind, export_formats, write_all
from asterism.print.job import Job
from asterism.print.rounded import better_layers, tiny_pieces
from asterism.results.files import EXPORT_COMPANIONS, EXPORT_SUMMARY_FILE, holds_result, staged
from asterism.results.records.export import (
    CheckSquareRecord,
    ExportRecord,
    GivenShapeRecord,
    LayersRecord,
    RoundingRecord,
    ShapeChangeRecord,
    SolidRecord,
    TinyStarRecord,
)
from asterism.shape.vtu import write_rods_vtu, write_shape_vtu

# name of the rounded design
ROUNDED = "rounded.toml"
# name of the files on demand, without their ending
MODEL_STEM = "model"
# files of some exports; those of an earlier export are removed
OPTIONAL_FILES: dict[str, tuple[FormatKind, ...]] = {
    "stars": ("solid", "script"),
    "rods": ("solid", "script"),
    "stars-below": ("solid",),
    "rods-below": ("solid",),
    "print-below": ("print",),
    "border": ("solid",),
    "middle-lines": ("drawing",),
    "needles": ("table", "drawing"),
    "shape": ("shape",),
    MODEL_STEM: ("model",),
}


def write_export(
    job: Job,
    directory: str | Path,
    change: ShapeChangeRecord | None = None,
    formats: Sequence[ExportFormat] = (),
) -> ExportRecord:
    """Write everything for printing a job into a directory, all or none; returns the content of export.json.

    Parameters
    ----------
    change : change of the shape by rounding, from `printed_shape`; None if it was not computed.
    formats : further formats of the whole job, from `demanded_formats`.

    Raises
    ------
    OutputError
        The files cannot be written there.
    """
    tiny = tiny_pieces(job.plan, job.plastic.tiny_arm_mm)
    with staged(directory, stale=_stale_files(directory)) as folder:
        for solid in job.solids:
            write_all("solid", folder, solid.name, solid)
        for name, solids in job.prints.items():
            write_all("print", folder, name, solids, job.design.name, job.rounding)
        if not job.below:
            write_all("script", folder, job.pattern_file, job)
        _write_sheets(job, folder)
        parts = instructions.chapters(job, tiny)
        write_all("pages", folder, "instructions", instructions.as_pages(job, parts))
        (folder / "instructions.txt").write_text(instructions.as_text(job, parts), encoding="utf-8", newline="\n")
        (folder / "start.gcode").write_text(job.start_code, encoding="utf-8", newline="\n")
        save_design(job.design, folder / ROUNDED)
        if job.shape is not None:
            write_all("shape", folder, "shape", job.shape, job.design.name)
            write_shape_vtu(job.shape, folder / "shape.vtu")
            if job.shape.rods:
                write_rods_vtu(job.shape, folder / "rods.vtu")
        for each in formats:
            each.write(folder / f"{MODEL_STEM}{each.suffix}", job)
        summary = _summary(job, tiny, change, sorted([EXPORT_SUMMARY_FILE, *(file.name for file in folder.iterdir())]))
        (folder / EXPORT_SUMMARY_FILE).write_text(summary.json_text(), encoding="utf-8")
    return summary


def export_file_names(has_shape: bool) -> list[str]:
    """Names of all files that an export can write; those of the sheet in space only if it has a shape.

    >>> from asterism.print.write import export_file_names
    >>> "print.3mf" in export_file_names(False), "shape.glb" in export_file_names(False)
    (True, False)
    """
    stems = {**OPTIONAL_FILES, "print": ("print",), "layout": ("drawing", "pages"), "instructions": ("pages",)}
    own = [ROUNDED, "instructions.txt", "start.gcode"]
    if has_shape:
        own += ["shape.vtu", "rods.vtu"]
    else:
        del stems["shape"]
    return sorted([*own, *_in_all_formats(stems)])


def _in_all_formats(stems: Mapping[str, Sequence[FormatKind]]) -> list[str]:
    return [
        f"{stem}{each.suffix}"
        for stem, kinds in stems.items()
        for kind in kinds
        for each in export_formats(kind, with_missing=True)
    ]


def _stale_files(directory: str | Path) -> str | None:
    """Pattern of the files of an earlier export that this export replaces or removes; None without one."""
    if not (Path(directory) / EXPORT_SUMMARY_FILE).is_file():
        return None
    # a drawing whose format cannot be written any more would show the sheet of the earlier export
    stems = {**OPTIONAL_FILES, "layout": ("drawing",)}
    names = [re.escape(name) for name in _in_all_formats(stems) if not re.fullmatch(EXPORT_COMPANIONS, name)]
    # the others may belong to that result
    return "|".join(names if holds_result(directory) else [*names, EXPORT_COMPANIONS])


def _write_sheets(job: Job, folder: Path) -> None:
    layout, template = sheets.layout_sheet(job), sheets.needle_sheet(job)
    pages = [layout, sheets.stretch_sheet(job)]
    write_all("drawing", folder, "layout", layout)
    if job.rods:
        write_all("drawing", folder, "middle-lines", middle_lines(job))
    if template is not None:
        pages.append(template)
        write_all("drawing", folder, "needles", template)
    if job.needles:
        write_all("table", folder, "needles", job.needles)
    write_all("pages", folder, "layout", pages)


def _summary(job: Job, tiny: list[TinyStarRecord], change: ShapeChangeRecord | None, files: list[str]) -> ExportRecord:
    return ExportRecord(
        design=job.design.to_dict(),
        printer=job.printer.model_dump(mode="json"),
        plastic=job.plastic.model_dump(mode="json"),
        stars=len(job.plan.centres),
        rods=len(job.plan.drawn_rods),
        rounding=_rounding(job),
        shape=None if job.shape is None else GivenShapeRecord(is_certain=job.is_certain, warnings=job.shape_warnings),
        shape_change=change,
        tiny_stars=tiny,
        solids={each.name: SolidRecord(volume_mm3=each.volume_mm3, box_mm=each.box.tolist()) for each in job.solids},
        printed_border=job.border is not None,
        turn_deg=job.placement.turn_deg,
        origin_on_bed_mm=[float(c) for c in job.placement.shift + job.printer.bed_centre_mm],
        z_offset_mm=job.z_offset_mm,
        fabric_given=job.fabric_given,
        check_square_mm=CheckSquareRecord(before=[job.check_before_mm] * 2, after=list(job.check_after_mm)),
        needles=len(job.needles),
        needles_in_plastic=job.needles_in_plastic,
        hangs_below_base_mm=job.hangs_mm,
        hangs_doubt_mm=job.hangs_doubt_mm,
        estimate=job.cost,
        files=files,
    )


def _rounding(job: Job) -> RoundingRecord:
    better = better_layers(job.drawn_plan, job.rounding)
    return RoundingRecord(
        **job.rounding.model_dump(mode="json"),
        thickness=job.size_changes["thickness"],
        width=job.size_changes["width"],
        better_layers=None if better is None else LayersRecord(**better.model_dump(mode="json")),
    )


def middle_lines(job: Job) -> Drawing:
    """The rods of the printed design in printed coordinates: a layer for each name and width, lines as wide as rods.

    A rod whose width varies has its mean width. The page is the box around the cut lines.
    """
    rods = job.plan.drawn_rods
    widths: dict[str, set[float]] = {}
    # characters that names of layers cannot have in DXF
    keys = [(re.sub(r'[<>/\\":;?*=`|,\x00-\x1f]', "_", rod.name), round(float(rod.width.mean()), 3)) for rod in rods]
    for name, width in keys:
        widths.setdefault(name, set()).add(width)
    layers = {
        (name, width): DrawingLayer(
            name if len(widths[name]) == 1 else f"{name} {width:g}", RODS.colour, width, is_printed_width=True
        )
        for name, width in dict.fromkeys(keys)
    }
    items = []
    for rod, key in zip(rods, keys, strict=True):
        closed = rod.start == rod.end
        items.append(Polyline(layers[key], rod.points[:-1] if closed else rod.points, closed=closed))
    everything = np.concatenate(job.cut)
    return Drawing(f"{job.design.name}: middle lines", everything.min(axis=0), everything.max(axis=0), tuple(items))
