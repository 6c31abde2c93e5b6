"""All files for the print of a design: the function behind `asterism export`."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design, save_design
from asterism.pattern.design.errors import DesignError, check_type
from asterism.pattern.design.materials import Plastic
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import free_motions
from asterism.pattern.layout.layout import Layout
from asterism.pattern.layout.symmetries import distances_of_images, symmetries
from asterism.print import instructions, sheets
from asterism.print.bed_placement import frame_warning
from asterism.print.formats.registry import (
    ExportFormat,
    FormatKind,
    demanded_formats,
    export_formats,
    formats_left_out,
    write_all,
)
from asterism.print.job import Job, prepare, with_shape
from asterism.print.printer import PlasticProfile, adjusted_printer, load_plastic, load_printer
from asterism.print.rounding import better_layers, tiny_pieces
from asterism.process.progress import Say
from asterism.process.settings import ExportSettings
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
from asterism.shape.shape import Shape
from asterism.shape.vtu import folder_of, read_shape, write_rods_vtu, write_shape_vtu

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
    "model": ("model",),
}


@dataclass(frozen=True)
class PrintExport:
    """A design made ready for a printer, with the files that were written."""

    job: Job  # the rounded design on the bed, with its solids, needles and costs
    summary: ExportRecord  # content of export.json
    # one line for each reason to doubt the print or its shape in space, and for each format that is left out
    warnings: tuple[str, ...]
    doubts: tuple[str, ...] = ()  # those of the warnings for which the shape is not reliable: it is not certified

    @property
    def files(self) -> list[str]:
        """Names of the files in the directory."""
        return list(self.summary.files)


def export(
    design: Design,
    directory: str | Path,
    settings: ExportSettings | None = None,
    *,
    shape: Shape | str | Path | None = None,
    law: Law[Any] | None = None,
    report: Callable[[str, Any], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> PrintExport:
    """Write all files for the print of a design: solids, 1:1 sheets, needles, start code, instructions.

    Thicknesses are rounded to layers, and widths to lines of the nozzle. `rounded.toml` is the rounded design.

    Parameters
    ----------
    settings : printer, plastic, fabric and what is written.
    shape : the sheet in space, or the folder of its results; its files are written too. Goes without `preview` and
        `simulate` of the settings, of which one may be set.
    law : law of the preview; that of the paper's material by default.
    report, say : called with the progress of the exact model.

    Raises
    ------
    DesignError
        The print does not fit the bed or the frame, a value is out of range, or the shape belongs to another design.
    LawError
        The preview has no law for this fabric.
    OutputError
        The files cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from asterism.pattern.gallery import load
    >>> from asterism.print.export import ExportSettings, export
    >>> exported = export(load("star"), tempfile.mkdtemp(), ExportSettings(printer="prusa-mk4", fabric_mm=0.5))
    >>> "print.3mf" in exported.files, round(exported.job.z_offset_mm, 2)
    (True, 4.5)
    """
    settings = ExportSettings() if settings is None else settings
    check_type(settings, ExportSettings, "ExportSettings(preview=True) is an example")
    check_shape_request(directory, settings, shape)
    demanded = demanded_formats(settings.formats)
    machine, profile = adjusted_printer(settings), load_plastic(settings.plastic)
    frame_is_known = settings.frame_mm is None and "frame" in load_printer(settings.printer).model_fields_set
    given = read_shape(shape) if isinstance(shape, str | Path) else shape
    # this finds most mistakes before anything is computed
    job = prepare(design, machine, profile, settings, given)
    warnings = [*formats_left_out(), *([] if frame_is_known else frame_warning(machine))]
    warnings += plastic_warning(design, profile)
    if job.below:
        warnings.append("the scripts for OpenSCAD and IceSL are left out: they have plastic on one side only")
    doubts = ["the given shape is not certified as a minimum"] if job.is_certain is False else []
    of_shapes = {"the given shape": job.shape_warnings}
    computed, change = printed_shape(job, law, report, say)
    if change is not None:
        for certified, which in zip(change.are_minima, ("drawn", "printed"), strict=False):
            if not certified:
                doubts.append(f"the shape of the {which} design is not certified as a minimum")
        by = "exact model" if settings.simulate else "preview"
        of_shapes[f"the shape by the {by}"] = list(change.get("warnings", ()))
    warnings += [*doubts, *said_once(of_shapes)]
    if computed is not None:
        is_written = settings.preview or settings.simulate
        job = with_shape(job, computed) if is_written else replace(job, glance=computed)
    return PrintExport(job, write_export(job, directory, change, demanded), tuple(warnings), tuple(doubts))


def check_shape_request(directory: str | Path, settings: ExportSettings, shape: Shape | str | Path | None) -> None:
    """Raise DesignError for two sources of the shape in space, or a directory whose results its files would replace."""
    given = (("--shape", shape is not None), ("--preview", settings.preview), ("--simulate", settings.simulate))
    options = [name for name, is_given in given if is_given]
    if len(options) > 1:
        raise DesignError(options[0], "must be the only one of --shape, --preview and --simulate")
    same_folder = isinstance(shape, str | Path) and Path(directory).resolve() == folder_of(Path(shape))
    if options and not same_folder and holds_result(directory):
        raise DesignError("--output", "holds other results, whose shape.vtu would be replaced", str(directory))


def printed_shape(
    job: Job,
    law: Law[Any] | None = None,
    report: Callable[[str, Any], None] | None = None,
    say: Say | None = None,
) -> tuple[Shape | None, ShapeChangeRecord | None]:
    """The shape of the rounded design, and its distance from the shape of the design as drawn; None if not computed.

    If the settings ask for none, the preview is computed if rounding changes the design, or if there are needles. If it
    has no law for the fabric or the pattern, the change has the `model` None and the reason in `why`.

    Raises LawError: the settings ask for a preview, and it has no law for this fabric.
    """
    preview, simulate = job.settings.preview, job.settings.simulate
    if not (simulate or preview or job.is_rounded or (job.needles and job.shape is None)):
        return None, None

    def shape_of(design: Design) -> Shape:
        if simulate:
            # the imports of the exact model take seconds
            from asterism.verification.simulate import simulate as solve

            return solve(design, report=report, say=say, law=law)
        from asterism.previews.session import preview as fast

        return fast(design, law)

    try:
        printed = shape_of(job.design)
        drawn = shape_of(job.drawn) if job.is_rounded else printed
    except (LawError, DesignError) as error:
        if preview or simulate:
            raise
        return None, ShapeChangeRecord(model=None, why=" ".join(str(error).split()), are_minima=[])
    return printed, shape_change(drawn, printed, job.design, job.plan, "exact" if simulate else "preview")


def shape_change(drawn: Shape, printed: Shape, design: Design, plan: Layout, model: str) -> ShapeChangeRecord:
    """Compare the shapes before and after rounding, both as their supports hold them.

    `design`, `plan`: the design and layout before or after rounding; both have the same stars; `model`: model of both
    shapes: `exact` or `preview`.
    """
    supports = plan.support_samples
    free = free_motions(supports, drawn.at_edges(supports.printed), design.gravity.pull)
    at, distance = plan.compared_points, 0.0
    if len(at) > 2:
        images = distances_of_images(at, drawn.at_edges(at), printed.at_edges, symmetries(design, plan), free)
        distance = float(images.min())
    outside = [shape.summary.get("stars_outside_law", ()) for shape in (printed, drawn)]
    change = ShapeChangeRecord(
        model=model,
        height_mm=[drawn.height_mm, printed.height_mm],
        extent_mm=[list(drawn.extent_mm), list(printed.extent_mm)],
        star_distance_mm=distance,
        star_distance_percent=100.0 * distance / diameter(drawn.positions),
        are_minima=[bool(shape.summary.get("is_minimum", False)) for shape in (drawn, printed)],
        stars_outside_law=len(outside[0] or outside[1]),
        warnings=list(printed.summary.get("warnings", [])),
    )
    return change | {"minima": printed.summary["minima"]} if model == "exact" else change


def plastic_warning(design: Design, plastic: PlasticProfile) -> Iterator[str]:
    """Yield a line if another plastic than the paper's is printed with the stiffness of the paper's."""
    # the plastic of the paper, whose stiffness is the default of designs
    ratio, paper = Plastic().modulus_ratio, load_plastic("tpu95a")
    if design.plastic.modulus_ratio == ratio and plastic.name != paper.name:
        yield (
            f"{plastic.name} is printed, but plastic.modulus_ratio = {ratio:g} of the design is that of {paper.name}: "
            "measure strips (asterism strips new), and give their --material"
        )


def said_once(of_shapes: Mapping[str, Sequence[str]]) -> list[str]:
    """Warnings by the shape that they are about, each text once.

    >>> said_once({"the given shape": ["it rolls", "it folds"], "the shape by the preview": ["it folds"]})
    ['the given shape: it rolls', 'the given shape and the shape by the preview: it folds']
    """
    shapes: dict[str, list[str]] = {}
    for shape, lines in of_shapes.items():
        for line in dict.fromkeys(lines):
            shapes.setdefault(line, []).append(shape)
    return [f"{' and '.join(names)}: {line}" for line, names in shapes.items()]


def write_export(
    job: Job,
    directory: str | Path,
    change: ShapeChangeRecord | None = None,
    formats: Sequence[ExportFormat] = (),
) -> ExportRecord:
    """Write everything for printing a job into a directory, all or none; returns the content of export.json.

    `change`: change of the shape by rounding, from `printed_shape`; None if it was not computed; `formats`: further
    formats of the whole job, from `demanded_formats`.

    Raises OutputError: the files cannot be written there.
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
        save_design(job.design, folder / "rounded.toml")
        if job.shape is not None:
            write_all("shape", folder, "shape", job.shape, job.design.name)
            write_shape_vtu(job.shape, folder / "shape.vtu")
            if job.shape.rods:
                write_rods_vtu(job.shape, folder / "rods.vtu")
        for each in formats:
            each.write(folder / f"model{each.suffix}", job)
        summary = _summary(job, tiny, change, sorted([EXPORT_SUMMARY_FILE, *(file.name for file in folder.iterdir())]))
        (folder / EXPORT_SUMMARY_FILE).write_text(summary.json_text(), encoding="utf-8")
    return summary


def export_file_names(has_shape: bool) -> list[str]:
    """Names of all files that an export can write; those of the sheet in space only if it has a shape.

    >>> from asterism.print.export import export_file_names
    >>> "print.3mf" in export_file_names(False), "shape.glb" in export_file_names(False)
    (True, False)
    """
    stems = {**OPTIONAL_FILES, "print": ("print",), "layout": ("drawing", "pages"), "instructions": ("pages",)}
    own = ["rounded.toml", "instructions.txt", "start.gcode"]
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
        write_all("drawing", folder, "middle-lines", sheets.middle_lines(job))
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
