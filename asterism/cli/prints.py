"""Files for a print, and the print that comes of them: `asterism export` and `compare`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

import asterism
from asterism.cli.options import (
    DesignFile,
    FileUnit,
    LawFile,
    MaterialFile,
    output_option,
    results_folder,
)
from asterism.cli.run import DONE, NO_ANSWER, Run, command
from asterism.print.settings import ExportSettings


@command
def export(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory (default: DESIGN-print).")] = None,
    material: MaterialFile = None,
    shape: Annotated[Path | None, typer.Option(help="Results of simulate, preview or verify, or a shape.vtu.")] = None,
    law: LawFile = None,
    *,
    settings: ExportSettings,
) -> None:
    """Write all files for a print: solids, layout at 1:1, needles, start code, instructions.

    Thicknesses are rounded to layers and widths to lines; rounded.toml is the printed design. The command states the
    effect of rounding on the shape, by the preview, or by the exact model with --simulate.
    """
    from asterism.laws.replace_material import with_material

    plan = with_material(
        asterism.load_design(design), material, run.warn
    )  # before slower imports: many mistakes are here

    from asterism.exact.cost import exact_cost
    from asterism.laws.design_law import law_from_file
    from asterism.print.export import check_shape_request, export_file_names
    from asterism.results.files import EXPORT_SUMMARY_FILE
    from asterism.verification.both_starts import BOTH_STARTS

    names = export_file_names(has_shape=settings.preview or settings.simulate or shape is not None)
    directory = results_folder(design, output, design.with_name(f"{design.stem}-print"), EXPORT_SUMMARY_FILE, *names)
    check_shape_request(directory, settings, shape)
    sheet = law_from_file(plan, law, design, material) if settings.preview or law else None
    if settings.simulate:
        run.cost(exact_cost(plan, BOTH_STARTS, shapes=2))
    with run.computing():
        exported = asterism.export(plan, directory, settings, shape=shape, law=sheet, report=run.report, say=run.say)
    run.warn(*(line for line in exported.warnings if line not in exported.doubts))
    run.result(exported.summary, directory, exported.files, exported.doubts)


@command
def compare(
    run: Run,
    shape: Annotated[Path, typer.Argument(help="Results of simulate, preview or verify, or a shape.vtu.")],
    scan: Annotated[Path, typer.Argument(help="A scan (.obj, .stl, .ply) or a photographed outline (.svg, .csv).")],
    output: Annotated[Path | None, output_option("Directory (default: SCAN-compared).")] = None,
    units: Annotated[FileUnit | None, typer.Option(help="Unit of the numbers in the file (default: mm).")] = None,
    view: Annotated[
        Literal["above", "front", "side"] | None,
        typer.Option(help="Direction of the photograph of an outline (default: above)."),
    ] = None,
    trim: Annotated[
        float, typer.Option(min=0.0, max=0.8, help="Largest part of the scan that does not belong to the sheet.")
    ] = 0.2,
) -> int:
    """Measure and draw the distance of a printed sheet from its computed shape.

    The scan is rotated and shifted onto the shape, but not mirrored or scaled. It may cover a part of the sheet.
    The exit status is 1 if the scan fits nowhere.
    """
    from asterism.measure.compare.compare import check_comparison_directory
    from asterism.measure.compare.scan import check_file

    check_file(scan)
    directory = output or scan.with_name(f"{scan.stem}-compared")
    check_comparison_directory(directory, shape)
    with run.computing():
        comparison = asterism.compare(shape, scan, units=units, view=view, trim=trim)
        files = asterism.write_comparison(comparison, directory)
    run.table(comparison.summary.table(), 22)
    run.files(directory, files)
    if not comparison.is_fit:
        percent = comparison.summary.rms_percent
        run.warn(f"{scan} fits nowhere, it is {percent:.0f} % of the diameter off (rms): is it of this design?")
    return DONE if comparison.is_fit else NO_ANSWER
