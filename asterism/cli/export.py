"""`asterism export`: everything that is needed to print a design; `asterism printers`: on what."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from asterism.cli.options import DesignFile, LawFile, MaterialFile, output_option

if TYPE_CHECKING:
    from asterism.print.job import Job
    from asterism.print.printer import Printer
    from asterism.shape.shape import Shape


def export(
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
    from asterism.print.changed import changed
    from asterism.print.job import prepare
    from asterism.print.printed_shape import printed_shape
    from asterism.print.profiles import load_plastic, load_printer
    from asterism.print.table import table
    from asterism.print.write import ROUNDED, SUMMARY, write_export
    from asterism.results.files import check_kept, check_writable, holds_result
    from asterism.results.read_shape import folder_of, read_shape
    from pattern.design.errors import DesignError
    from pattern.layout.load_design import load_design

    asked = [
        name for name, it in (("--shape", shape is not None), ("--preview", preview), ("--simulate", simulate)) if it
    ]
    if len(asked) > 1:
        raise DesignError(asked[0], "must be the only one of --shape, --preview and --simulate")
    plan = with_material(load_design(design), material)
    machine = changed(load_printer(printer), first_layer, layer, plate)
    directory = output or design.with_name(f"{design.stem}-print")
    check_kept(design, directory, ROUNDED, SUMMARY)
    check_writable(directory, SUMMARY)
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
        print("asterism: the given shape is not certain to stay", file=sys.stderr)
    for line in ready.shape_warnings:
        print(f"asterism: the given shape: {line}", file=sys.stderr)
    computed, change = printed_shape(ready, preview, simulate, sheet)
    for certain, which in zip(change["are_minima"] if change else (), ("drawn", "printed"), strict=False):
        if not certain:
            print(f"asterism: the {which} design's shape is not certain to stay", file=sys.stderr)
    for line in change.get("warnings", ()) if change else ():
        print(f"asterism: the shape by the {'exact model' if simulate else 'preview'}: {line}", file=sys.stderr)
    if computed is not None:
        ready = job(computed) if preview or simulate else replace(ready, glance=computed)
    summary = write_export(ready, directory, change)
    for name, text in table(summary).items():
        typer.echo(f"  {name:<20} {text}")
    typer.echo(f"{directory}: {', '.join(summary['files'])}")


def printers() -> None:
    """List printers and plastics, and where your own are looked for.

    Exit status 2 if a file of yours is wrong; the others are listed all the same.
    """
    from asterism.print.profiles import VARIABLE, folders, load_plastic, load_printer, names
    from pattern.design.errors import DesignError

    kinds: dict[str, Callable[[str], str]] = {
        "printers": lambda name: _of_printer(load_printer(name)),
        "plastics": lambda name: load_plastic(name).name,
    }
    wrong = []
    for kind, described in kinds.items():
        for name in names(kind):
            try:
                typer.echo(f"  {name:<14} {described(name)}")
            except DesignError as error:
                wrong.append(" ".join(str(error).split()))
    *own, _ = folders()
    typer.echo(f"yours: printers/NAME.toml and plastics/NAME.toml in {' or '.join(map(str, own))} ({VARIABLE})")
    for line in wrong:
        print(f"asterism: {line}", file=sys.stderr)
    if wrong:
        raise typer.Exit(2)


def _of_printer(machine: Printer) -> str:
    width, depth = machine.bed_mm
    layers = " or ".join(f"{height:g}" for height in machine.first_layers_mm)
    return f"{machine.name}: {width:g} x {depth:g} mm, layers {layers} + n {machine.layer_mm:g} mm"
