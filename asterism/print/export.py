"""All files for the print of a design: the function behind `asterism export`."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.pattern.design.design import Design
from asterism.pattern.design.errors import DesignError
from asterism.pattern.design.materials import Plastic
from asterism.pattern.geometry.diameter import diameter
from asterism.pattern.layout.free_motions import free_motions
from asterism.pattern.layout.layout import Layout, off_sheet_mm
from asterism.pattern.layout.symmetries import distances_of_images, symmetries
from asterism.print.bed_placement import frame_warning
from asterism.print.formats.registry import demanded_formats, formats_left_out
from asterism.print.job import Job, prepare, with_shape
from asterism.print.needles import NEEDLE_SPACING_MM
from asterism.print.printer import PlasticProfile, Printer, adjusted_printer, load_plastic, load_printer
from asterism.print.write import write_export
from asterism.process.listeners import Say
from asterism.results.files import holds_result
from asterism.results.records.export import ExportRecord, ShapeChangeRecord
from asterism.shape.shape import Shape
from asterism.shape.vtu import folder_of, read_shape


@dataclass(frozen=True)
class PrintExport:
    """A design made ready for a printer, with the files that were written.

    Attributes
    ----------
    job : the rounded design on the bed, with its solids, needles and costs.
    summary : content of export.json.
    warnings : one line for each reason to doubt the print or its shape in space, and for each format that is left out.
    doubts : those of the warnings for which the shape is not reliable: it is not certified.
    """

    job: Job
    summary: ExportRecord
    warnings: tuple[str, ...]
    doubts: tuple[str, ...] = ()

    @property
    def files(self) -> list[str]:
        """Names of the files in the directory."""
        return list(self.summary.files)


def export(
    design: Design,
    directory: str | Path,
    *,
    printer: str | Printer = "ultimaker2",
    plastic: str | PlasticProfile = "tpu95a",
    shape: Shape | str | Path | None = None,
    preview: bool = False,
    simulate: bool = False,
    law: Law[Any] | None = None,
    first_layer_mm: float | None = None,
    layer_mm: float | None = None,
    plate_mm: float | None = None,
    frame_mm: Sequence[float] | None = None,
    fabric_mm: float | None = None,
    fabric_set_percent: float = 0.0,
    turn_deg: float = 0.0,
    needle_spacing_mm: float = NEEDLE_SPACING_MM,
    border: bool = True,
    formats: Sequence[str] = (),
    report: Callable[[str, Any], None] | None = None,
    say: Callable[[str], None] | None = None,
) -> PrintExport:
    """Write all files for the print of a design: solids, 1:1 sheets, needles, start code, instructions.

    Thicknesses are rounded to layers, and widths to lines of the nozzle. `rounded.toml` is the rounded design.

    Parameters
    ----------
    printer, plastic : a profile, its name (`asterism printers` lists them), or its file.
    shape : the sheet in space, or the folder of its results; its files are written too.
    preview, simulate : compute the shape of the rounded design with the preview or the exact model.
        At most one of `shape`, `preview` and `simulate` may be given.
    law : law of the preview; that of the paper's material by default.
    first_layer_mm, layer_mm, plate_mm, frame_mm : heights of the layers, thickness of the plate under the fabric, and
        width and depth of the frame,
        in place of the printer's.
    fabric_mm : thickness of the stretched fabric; by default the design's, which is that of the released fabric.
    fabric_set_percent : by how much a bare piece of the fabric is longer after its release than before it was
        stretched. The check square of the layout then is stretched further than the design says by as much.
    turn_deg : counterclockwise turn of the print on the bed.
    needle_spacing_mm : largest distance between needles on supported edges.
    border : print a line to cut along, if it fits on the bed.
    formats : further formats: `3dm` for Rhino (requires rhino3dm), with the sheet in space if its shape is known.
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
    >>> from asterism.print.export import export
    >>> exported = export(load("star"), tempfile.mkdtemp(), printer="prusa-mk4", fabric_mm=0.5)
    >>> "print.3mf" in exported.files, round(exported.job.z_offset_mm, 2)
    (True, 4.5)
    """
    check_shape_request(directory, shape, preview, simulate)
    demanded = demanded_formats(formats)
    machine = load_printer(printer)
    frame_is_known = frame_mm is None and "frame" in machine.model_fields_set
    machine = adjusted_printer(machine, first_layer_mm, layer_mm, plate_mm, frame_mm)
    profile = load_plastic(plastic)
    given = read_shape(shape) if isinstance(shape, str | Path) else shape

    # this finds most mistakes before anything is computed
    job = prepare(
        design,
        machine,
        profile,
        fabric_mm=fabric_mm,
        fabric_set_percent=fabric_set_percent,
        border=border,
        turn_deg=turn_deg,
        needle_spacing_mm=needle_spacing_mm,
        shape=given,
    )
    warnings = [*formats_left_out(), *([] if frame_is_known else frame_warning(machine))]
    warnings += plastic_warning(design, profile)
    if job.below:
        warnings.append("the scripts for OpenSCAD and IceSL are left out: they have plastic on one side only")
    doubts = ["the given shape is not certified as a minimum"] if job.is_certain is False else []
    of_shapes = {"the given shape": job.shape_warnings}
    computed, change = printed_shape(job, preview, simulate, law, report, say)
    if change is not None:
        for certified, which in zip(change.are_minima, ("drawn", "printed"), strict=False):
            if not certified:
                doubts.append(f"the shape of the {which} design is not certified as a minimum")
        by = "exact model" if simulate else "preview"
        of_shapes[f"the shape by the {by}"] = list(change.get("warnings", ()))
    warnings += [*doubts, *said_once(of_shapes)]
    if computed is not None:
        is_written = preview or simulate
        job = with_shape(job, computed, needle_spacing_mm) if is_written else replace(job, glance=computed)
    return PrintExport(job, write_export(job, directory, change, demanded), tuple(warnings), tuple(doubts))


def check_shape_request(
    directory: str | Path, shape: Shape | str | Path | None = None, preview: bool = False, simulate: bool = False
) -> None:
    """Raise DesignError for two sources of the shape in space, or a directory whose results its files would replace."""
    given = (("--shape", shape is not None), ("--preview", preview), ("--simulate", simulate))
    options = [name for name, is_given in given if is_given]
    if len(options) > 1:
        raise DesignError(options[0], "must be the only one of --shape, --preview and --simulate")
    same_folder = isinstance(shape, str | Path) and Path(directory).resolve() == folder_of(Path(shape))
    if options and not same_folder and holds_result(directory):
        raise DesignError("--output", "holds other results, whose shape.vtu would be replaced", str(directory))


def printed_shape(
    job: Job,
    preview: bool,
    simulate: bool,
    law: Law[Any] | None = None,
    report: Callable[[str, Any], None] | None = None,
    say: Say | None = None,
) -> tuple[Shape | None, ShapeChangeRecord | None]:
    """The shape of the rounded design, and its distance from the shape of the design as drawn; None if not computed.

    Without `preview` or `simulate`, the preview is computed if rounding changes the design, or if there are needles. If
    it has no law for the fabric or the pattern, the change has the `model` None and the reason in `why`.

    Raises
    ------
    LawError
        `preview` is set, and the preview has no law for this fabric.
    """
    if not (simulate or preview or job.is_rounded or (job.needles and job.shape is None)):
        return None, None

    def shape_of(design: Design) -> Shape:
        if simulate:
            # the imports of the exact model take seconds
            from asterism.verification.both_starts import simulate as solve

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

    Parameters
    ----------
    design, plan : the design and layout before or after rounding; both have the same stars.
    model : model of both shapes: `exact` or `preview`.
    """
    supports = plan.support_samples
    off_sheet = off_sheet_mm(plan, min(len(drawn.printed), len(printed.printed)))
    free = free_motions(supports, drawn.at(supports.printed, off_sheet), design.gravity.pull)
    at, distance = plan.compared_points, 0.0
    if len(at) > 2:
        before, after_at = drawn.at(at, off_sheet), partial(printed.at, off_sheet_mm=off_sheet)
        distance = float(distances_of_images(at, before, after_at, symmetries(design, plan), free).min())
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
    return change.changed(minima=printed.summary["minima"]) if model == "exact" else change


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
