"""Files for a print, and the print that comes of them: `asterism export` and `compare`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from asterism.cli.options import (
    DesignFile,
    FileUnit,
    LawFile,
    MaterialFile,
    PlasticName,
    PrinterName,
    output_option,
    results_folder,
    two_sizes,
)
from asterism.cli.run import DONE, NO_ANSWER, Run, command


@command
def export(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory (default: DESIGN-print).")] = None,
    printer: PrinterName = "ultimaker2",
    plastic: PlasticName = "tpu95a",
    material: MaterialFile = None,
    shape: Annotated[Path | None, typer.Option(help="Results of simulate, preview or verify, or a shape.vtu.")] = None,
    preview: Annotated[
        bool, typer.Option("--preview", help="Compute the printed shape by the preview, and write its files.")
    ] = False,
    law: LawFile = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="The same by the exact model, with the effect of rounding.")
    ] = False,
    first_layer: Annotated[float | None, typer.Option(help="Height of the first layer in mm.")] = None,
    layer: Annotated[float | None, typer.Option(help="Height of the other layers in mm.")] = None,
    plate: Annotated[float | None, typer.Option(help="Thickness of the plate under the fabric in mm.")] = None,
    frame: Annotated[
        str | None,
        typer.Option(
            help="Width and depth of the frame with its bars in mm, such as 300x250 (default: the printer's)."
        ),
    ] = None,
    fabric: Annotated[
        float | None,
        typer.Option(help="Thickness of the stretched fabric in mm (default: that of the released fabric)."),
    ] = None,
    fabric_set: Annotated[
        float, typer.Option(help="Percent by which the fabric stays longer after its release: stretched further by it.")
    ] = 0.0,
    turn: Annotated[float, typer.Option(help="Rotation of the print on the bed in degrees, counterclockwise.")] = 0.0,
    needle_spacing: Annotated[float, typer.Option(help="Largest distance of needles on supported edges in mm.")] = 20.0,
    border: Annotated[bool, typer.Option("--border/--no-border", help="Print a line to cut along.")] = True,
    formats: Annotated[
        list[str] | None, typer.Option("--format", help="Also write this format: 3dm for Rhino (requires rhino3dm).")
    ] = None,
) -> None:
    """Write all files for a print: solids, layout at 1:1, needles, start code, instructions.

    Thicknesses are rounded to layers and widths to lines; rounded.toml is the printed design. The command states the
    effect of rounding on the shape, by the preview, or by the exact model with --simulate.
    """
    from asterism.laws.replace_material import with_material
    from asterism.pattern.layout.build import load_design

    plan = with_material(load_design(design), material, run.warn)  # before slower imports: many mistakes are here

    from asterism.exact.cost import exact_cost
    from asterism.laws.design_law import law_from_file
    from asterism.print.export import check_shape_request
    from asterism.print.export import export as write
    from asterism.print.write import export_file_names
    from asterism.results.files import EXPORT_SUMMARY_FILE
    from asterism.verification.both_starts import BOTH_STARTS

    names = export_file_names(has_shape=preview or simulate or shape is not None)
    directory = results_folder(design, output, design.with_name(f"{design.stem}-print"), EXPORT_SUMMARY_FILE, *names)
    check_shape_request(directory, shape, preview, simulate)
    sheet = law_from_file(plan, law, design, material) if preview or law else None
    if simulate:
        run.cost(exact_cost(plan, BOTH_STARTS, shapes=2))
    with run.computing():
        exported = write(
            plan,
            directory,
            printer=printer,
            plastic=plastic,
            shape=shape,
            preview=preview,
            simulate=simulate,
            law=sheet,
            first_layer_mm=first_layer,
            layer_mm=layer,
            plate_mm=plate,
            frame_mm=None if frame is None else two_sizes(frame, "--frame"),
            fabric_mm=fabric,
            fabric_set_percent=fabric_set,
            turn_deg=turn,
            needle_spacing_mm=needle_spacing,
            border=border,
            formats=formats or (),
            report=run.report,
            say=run.say,
        )
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
    from asterism.measure.compare.compare import check_comparison_directory, write_comparison
    from asterism.measure.compare.compare import compare as measure
    from asterism.measure.compare.scan import check_file

    check_file(scan)
    directory = output or scan.with_name(f"{scan.stem}-compared")
    check_comparison_directory(directory, shape)
    with run.computing():
        comparison = measure(shape, scan, units=units, view=view, trim=trim)
        files = write_comparison(comparison, directory)
    run.table(comparison.summary.table(), 22)
    run.files(directory, files)
    if not comparison.is_fit:
        percent = comparison.summary.rms_percent
        run.warn(f"{scan} fits nowhere, it is {percent:.0f} % of the diameter off (rms): is it of this design?")
    return DONE if comparison.is_fit else NO_ANSWER
