"""`asterism export`: the files needed to print a design."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from asterism.cli.common.options import DesignFile, LawFile, MaterialFile, output_option
from asterism.cli.common.run import Run, command

if TYPE_CHECKING:
    from asterism.print.job import Job
    from asterism.shape.shape import Shape


@command
def export(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory (DESIGN-print).")] = None,
    printer: Annotated[str, typer.Option(help="A printer by name, or its file; see asterism printers.")] = "ultimaker2",
    plastic: Annotated[str, typer.Option(help="A plastic by name, or its file.")] = "tpu95a",
    material: MaterialFile = None,
    shape: Annotated[Path | None, typer.Option(help="Results of simulate, preview or verify, or a shape.vtu.")] = None,
    preview: Annotated[
        bool, typer.Option("--preview", help="Write the printed shape's files too, from the fast preview.")
    ] = False,
    law: LawFile = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Likewise from the exact model, which also says what rounding changes.")
    ] = False,
    first_layer: Annotated[float | None, typer.Option(help="Height of the first layer in mm.")] = None,
    layer: Annotated[float | None, typer.Option(help="Height of the other layers in mm.")] = None,
    plate: Annotated[float | None, typer.Option(help="Thickness of the plate under the fabric in mm.")] = None,
    fabric: Annotated[
        float | None, typer.Option(help="Thickness of the stretched fabric in mm (the design's, of the released one).")
    ] = None,
    turn: Annotated[float, typer.Option(help="Turn the print on the bed, in degrees counterclockwise.")] = 0.0,
    needle_spacing: Annotated[float, typer.Option(help="Largest distance of needles on held edges in mm.")] = 20.0,
    border: Annotated[bool, typer.Option("--border/--no-border", help="Print a line to cut along.")] = True,
) -> None:
    """Everything for printing a design: solids, 1:1 sheets, needles, start code, instructions.

    Thicknesses are rounded to layers and widths to lines; rounded.toml is what is printed. What rounding does to the
    shape is said by the preview, or with --simulate by the exact model.
    """
    from asterism.laws.material import with_material
    from asterism.laws.own_law import law_for
    from asterism.print.adjusted_printer import adjusted_printer
    from asterism.print.export_table import export_rows
    from asterism.print.job import prepare
    from asterism.print.printed_shape import printed_shape
    from asterism.print.profiles import load_plastic, load_printer
    from asterism.print.write import ROUNDED, write_export
    from asterism.results.files import EXPORT, check_kept, check_writable, holds_result
    from asterism.results.read_shape import folder_of, read_shape
    from pattern.design.errors import DesignError
    from pattern.layout.load_design import load_design

    asked = [
        name for name, it in (("--shape", shape is not None), ("--preview", preview), ("--simulate", simulate)) if it
    ]
    if len(asked) > 1:
        raise DesignError(asked[0], "must be the only one of --shape, --preview and --simulate")
    plan = with_material(load_design(design), material)
    machine = adjusted_printer(load_printer(printer), first_layer, layer, plate)
    directory = output or design.with_name(f"{design.stem}-print")
    check_kept(design, directory, ROUNDED, EXPORT)
    check_writable(directory, EXPORT)
    elsewhere = shape is not None and directory.resolve() != folder_of(shape)
    if (preview or simulate or elsewhere) and holds_result(directory):
        raise DesignError("--output", "holds other results, whose shape.vtu would be replaced", str(directory))
    known = None if shape is None else read_shape(shape)
    sheet = law_for(plan, law, design, material) if preview or law else None

    def job(of: Shape | None) -> Job:
        return prepare(
            plan,
            machine,
            load_plastic(plastic),
            fabric_mm=fabric,
            border=border,
            turn_deg=turn,
            needle_spacing_mm=needle_spacing,
            shape=of,
        )

    # before anything is computed: most mistakes are found here
    ready = job(known)
    if ready.is_certain is False:
        run.warn("the given shape is not certain to stay")
    for line in ready.shape_warnings:
        run.warn(f"the given shape: {line}")
    with run.computing():
        computed, change = printed_shape(ready, preview, simulate, sheet, run.report, run.say)
    for certain, which in zip(change["are_minima"] if change else (), ("drawn", "printed"), strict=False):
        if not certain:
            run.warn(f"the {which} design's shape is not certain to stay")
    for line in change.get("warnings", ()) if change else ():
        run.warn(f"the shape by the {'exact model' if simulate else 'preview'}: {line}")
    if computed is not None:
        ready = job(computed) if preview or simulate else replace(ready, glance=computed)
    summary = write_export(ready, directory, change)
    run.table(export_rows(summary))
    run.files(directory, summary["files"])
