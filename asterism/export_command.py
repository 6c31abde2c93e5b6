"""`asterism export`: everything that is needed to print a design; `asterism printers`: on what."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from asterism.export.job import Job
    from asterism.export.printer import Printer
    from asterism.shape import Shape
    from pattern.design import Design


def export(
    design: Annotated[Path, typer.Argument(help="The design file (.toml or .json).")],
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Directory (DESIGN-print).")] = None,
    printer: Annotated[str, typer.Option(help="A printer by name, or its file; see asterism printers.")] = "ultimaker2",
    plastic: Annotated[str, typer.Option(help="A plastic by name, or its file.")] = "tpu95a",
    material: Annotated[
        Path | None, typer.Option(help="A material's file: its fabric and plastic in place of the design's.")
    ] = None,
    shape: Annotated[Path | None, typer.Option(help="Results of asterism simulate, or their shape.vtu.")] = None,
    simulate: Annotated[
        bool, typer.Option("--simulate", help="Compute the printed shape, and what rounding changes.")
    ] = False,
    first_layer: Annotated[float | None, typer.Option(help="Height of the first layer in mm.")] = None,
    layer: Annotated[float | None, typer.Option(help="Height of the other layers in mm.")] = None,
    plate: Annotated[float | None, typer.Option(help="Thickness of the plate under the fabric in mm.")] = None,
    fabric: Annotated[
        float | None, typer.Option(help="Thickness of the stretched fabric in mm (the design's fabric.thickness_mm).")
    ] = None,
    turn: Annotated[float, typer.Option(help="Turn the print on the bed, in degrees counterclockwise.")] = 0.0,
    needle_spacing: Annotated[float, typer.Option(help="Largest distance of needles on held edges in mm.")] = 20.0,
    border: Annotated[bool, typer.Option("--border/--no-border", help="Print a line to cut along.")] = True,
) -> None:
    """Everything for printing a design: solids, 1:1 sheets, needles, start code, instructions.

    Thicknesses are rounded to layers and widths to lines; the summary and rounded.toml say what is printed.
    """
    from asterism.export.job import prepare
    from asterism.export.profiles import load_plastic, load_printer
    from asterism.export.write import write_export
    from asterism.files import check_writable
    from asterism.material import with_material
    from asterism.read_shape import read_shape
    from pattern.design import load_design
    from pattern.errors import DesignError

    if shape is not None and simulate:
        raise DesignError("--shape", "goes without --simulate: either the shape is there or it is computed")
    for option, value, limits in (
        ("--fabric", fabric, (0.0, 50.0)),
        ("--needle-spacing", needle_spacing, (1.0, 1000.0)),
        ("--turn", turn, (-360.0, 360.0)),
    ):
        if value is not None and not limits[0] <= value <= limits[1]:
            raise DesignError(option, f"must be from {limits[0]:g} to {limits[1]:g}", value)
    plan = with_material(load_design(design), material)
    machine = _changed(load_printer(printer), first_layer, layer, plate)
    directory = output or design.with_name(f"{design.stem}-print")
    check_writable(directory)
    known = None if shape is None else read_shape(shape)

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
    change = None
    if simulate:
        printed, change = _simulated(plan, ready)
        ready = job(printed)
    summary = write_export(ready, directory, change)
    for name, text in _table(summary).items():
        typer.echo(f"  {name:<20} {text}")
    typer.echo(f"{directory}: {', '.join(summary['files'])}")


def printers() -> None:
    """List printers and plastics, and where your own are looked for."""
    from asterism.export.profiles import VARIABLE, folders, load_plastic, load_printer, names

    for name in names("printers"):
        machine = load_printer(name)
        width, depth = machine.bed_mm
        layers = " or ".join(f"{height:g}" for height in machine.first_layers_mm)
        typer.echo(
            f"  {name:<14} {machine.name}: {width:g} x {depth:g} mm, layers {layers} + n {machine.layer_mm:g} mm"
        )
    for name in names("plastics"):
        typer.echo(f"  {name:<14} {load_plastic(name).name}")
    *own, _ = folders()
    typer.echo(f"yours: printers/NAME.toml and plastics/NAME.toml in {' or '.join(map(str, own))} ({VARIABLE})")


def _changed(machine: Printer, first_layer: float | None, layer: float | None, plate: float | None) -> Printer:
    """The printer with what the options say."""
    from pydantic import ValidationError

    from asterism.export.printer import Printer
    from pattern.errors import DesignError, from_validation

    data = machine.model_dump(mode="json")
    data["first_layers_mm"] = data["first_layers_mm"] if first_layer is None else [first_layer]
    data["layer_mm"] = data["layer_mm"] if layer is None else layer
    data["frame"]["plate_mm"] = data["frame"]["plate_mm"] if plate is None else plate
    options = {"first_layers_mm[0]": "--first-layer", "layer_mm": "--layer", "frame.plate_mm": "--plate"}
    try:
        return Printer.model_validate(data)
    except ValidationError as error:
        wrong = from_validation(error)
        raise DesignError(options.get(wrong.field, wrong.field), wrong.allowed, wrong.value) from None


def _simulated(design: Design, ready: Job) -> tuple[Shape, dict[str, Any]]:
    """The printed shape, and how far it is from the drawn one."""
    from asterism.export.rounded import changes, exact
    from asterism.export.shape_change import shape_change
    from asterism.progress import Progress
    from asterism.simulation import simulate

    progress = Progress()
    try:
        printed = simulate(ready.design, report=progress.report, say=progress.say)
        rounded = any(size["stars_changed"] for size in changes(ready.exact_plan, ready.plan).values())
        drawn = printed if not rounded else simulate(exact(design), report=progress.report, say=progress.say)
    finally:
        progress.close()
    for shape, which in ((printed, "printed"), (drawn, "drawn")):
        if not shape.summary["is_minimum"]:
            print(f"asterism: the {which} shape is not certain: its summary says why", file=sys.stderr)
    return printed, shape_change(drawn, printed, ready.design, ready.plan)


def _table(s: dict[str, Any]) -> dict[str, str]:
    """What the command prints at its end."""
    rounding, cost = s["rounding"], s["estimate"]
    rows = {"printer": f"{s['printer']['name']}, {s['plastic']['name']}"}
    for name in ("thickness", "width"):
        sizes = rounding[name]
        values = ", ".join(f"{value:g}" for value in sizes["values_mm"])
        changed = (
            f"; {sizes['stars_changed']} of {s['stars']} stars changed by up to {sizes['largest_change_mm']:+.3f} mm"
        )
        rows[name] = f"{values} mm" + (changed if sizes["stars_changed"] else ", as drawn")
    rows["layers"] = f"first {rounding['first_layer_mm']:g} mm, then {rounding['layer_mm']:g} mm"
    if better := rounding["better_layers"]:
        rows["better"] = (
            f"--first-layer {better['first_layer_mm']:g} --layer {better['layer_mm']:g} is nearer to the design"
        )
    rows["change of shape"] = _change(s["shape_change"])
    if tiny := s["tiny_stars"]:
        places = ", ".join(f"[{x:g}, {y:g}]" for x, y in (star["at_mm"] for star in tiny[:4]))
        rows["tiny stars"] = f"{len(tiny)}, may jump off: at {places}" + (", ..." if len(tiny) > 4 else "")
    rows["z offset"] = f"{s['z_offset_mm']:.2f} mm (plate and stretched fabric), in start.gcode"
    x, y = s["check_square_mm"]["after"]
    rows["check square"] = f"100 mm before stretching, {x:.1f} x {y:.1f} mm after"
    rows["needles"] = str(s["needles"])
    rows["estimate"] = f"{cost['minutes']:.0f} min, {cost['mass_g']:.2f} g, {cost['filament_m']:.2f} m"
    return rows


def _change(change: dict[str, Any] | None) -> str:
    if change is None:
        return "not computed; --simulate does"
    before, after = change["height_mm"]
    distance = f"{change['star_distance_mm']:.2f} mm ({change['star_distance_percent']:.1f} % of the diameter)"
    return f"{distance}, height {before:.2f} -> {after:.2f} mm"
