"""The commands of `asterism strips`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import asterism
from asterism.cli.options import nonempty_path, output_option
from asterism.cli.run import Mistake, Run, command
from asterism.measure.strips.settings import StripFitSettings, StripPrintSettings
from asterism.process.environment import quoted


@command
def new(
    run: Run,
    output: Annotated[Path, output_option("Directory of the files.")] = Path("strips"),
    *,
    settings: StripPrintSettings,
) -> None:
    """Write a test print: strips as STL and 3MF, start code, instructions, and a table to fill in."""
    written = asterism.new_strips(output, settings)
    machine = written.printer
    first, others = written.layers_mm
    thick = ", ".join(f"{h:g}" for h in written.thicknesses_mm)
    kind = "released" if settings.fabric_mm is None else "stretched"
    table = quoted(output / "strips.csv")
    lie = ", half of them across the grain" if settings.both_directions else ""
    length, width = written.strips[0].size_mm
    other_layers = []
    if written.layers_mm != (machine.first_layers_mm[0], machine.layer_mm):
        stars = f"first {machine.first_layers_mm[0]:g} mm, then {machine.layer_mm:g} mm"
        option = f"--first-layer {first:g} --layer {others:g}"
        other_layers = [f"  stars are sliced in other layers ({stars}): export them with  {option}  for equal plastic"]
    run.lines(
        [
            f"  {len(written.strips)} strips of {length:g} x {width:g} mm{lie}, {thick} mm thick",
            f"  slice with a first layer of {first:g} mm and others of {others:g} mm",
            *other_layers,
            f"  z offset {written.z_offset_mm:.2f} mm (plate and {kind} fabric), in start.gcode",
            f"{output}: {', '.join(written.files)}; measure, fill in the table, then  asterism strips fit {table}",
        ]
    )


@command
def fit(
    run: Run,
    strips: Annotated[Path, typer.Argument(help="Table of measured strips (.csv).")],
    output: Annotated[
        Path | None, output_option("File of the material (default: material.toml beside the table).")
    ] = None,
    save: Annotated[
        str | None, typer.Option(help="Also keep the material under this name in your list (see asterism materials).")
    ] = None,
    *,
    settings: StripFitSettings,
) -> None:
    """Compute E1/E2 and kappa_bar from measured strips, and write a material file for the other commands.

    The exit status is 1 if the strips do not determine these values.
    """
    from asterism.measure.strips.fit_strips import check_material_path
    from asterism.pattern.design.material_files import own_material_path

    path = output or strips.parent / "material.toml"
    check_material_path(path)
    kept = None if save is None else own_material_path(save, "--save")
    if kept is not None:
        check_material_path(kept)
    material = asterism.fit_strips(strips, settings)
    name, picture, numbers = asterism.write_material(material, path)
    run.table(material.summary.table())
    run.lines(f"  {line}" for line in [*material.left_out, *material.sentences])
    run.lines([f"{path.with_name(name)}: the material, for --material and asterism calibrate; {picture}, {numbers}"])
    if kept is not None:
        kept.parent.mkdir(parents=True, exist_ok=True)
        asterism.write_material(material, kept)
        run.lines([f"{kept}: kept, for --material {kept.stem} and file = {kept.stem!r} in [material] of a design"])
    run.warn(*material.warnings)


@command
def weigh(
    run: Run,
    mass: Annotated[float, typer.Option(help="Mass in grams of the weight with its clamp.")],
    width: Annotated[float, typer.Option(help="Width in mm of the released strip of fabric.")],
    thickness: Annotated[float, typer.Option(help="Thickness in mm of the released fabric.")],
    before: Annotated[float, typer.Option(help="Distance in mm of two marks on the strip without the weight.")],
    after: Annotated[float, typer.Option(help="Their distance in mm under the weight.")],
    poisson: Annotated[float, typer.Option(help="fabric.poisson of the design.")] = 0.3,
    incompressible: Annotated[
        bool, typer.Option("--incompressible", help='For fabric.model = "incompressible".')
    ] = False,
) -> None:
    """Compute Young's modulus of a fabric from a strip that hangs with a weight, for designs with gravity."""
    from asterism.measure.fabric import fabric_modulus_mpa

    if not 1.0 <= before <= 1e4:
        raise Mistake(f"--before: must be from 1 to 10000 mm, not {before:g}")
    modulus = fabric_modulus_mpa(
        mass, width, thickness, after / before, poisson, "incompressible" if incompressible else "neo-hookean"
    )
    run.table({"stretch": f"{after / before:.3f}", "modulus_mpa": f"{modulus:.4g} MPa"})


@command
def overhang(
    run: Run,
    lengths: Annotated[
        list[str] | None,
        typer.Argument(metavar="[MM...|TABLE]", help="Overhangs at the slope of 41.5 degrees, or their table (.csv)."),
    ] = None,
    mass: Annotated[float | None, typer.Option(help="Mass in grams of a square metre of the released fabric.")] = None,
    form: Annotated[
        Path | None,
        typer.Option(
            help="Write the table to fill in, and a page to print, into this directory.", parser=nonempty_path
        ),
    ] = None,
) -> None:
    """Compute the bending stiffness of a fabric from strips that hang over an edge (cantilever test)."""
    from asterism.measure.fabric import bending_stiffness, read_overhangs, write_overhang_form
    from asterism.pattern.design.errors import DesignError

    if form is not None:
        if lengths or mass is not None:
            raise Mistake("--form: writes an empty table; give no overhangs and no --mass")
        table, page = write_overhang_form(form)
        filled = quoted(form / table)
        run.lines([f"{form}: {table}, {page}; measure, fill in the table, then  asterism strips overhang {filled}"])
        return
    if not lengths:
        raise Mistake("MM: give overhangs in mm or their table; --form overhangs writes an empty table")
    if mass is None:
        raise Mistake("--mass: is missing; give the grams of a square metre of the released fabric")
    is_table = len(lengths) == 1 and lengths[0].lower().endswith(".csv")
    values = read_overhangs(Path(lengths[0])) if is_table else [_overhang(text) for text in lengths]
    try:
        stiffness = bending_stiffness(values, mass)
    except DesignError as error:
        raise DesignError(error.field.replace("mass_g_m2", "--mass"), error.allowed, error.value) from None
    interval = f", one {'strip' if is_table else 'reading'} only"
    if len(values) > 1:
        interval = f" ({stiffness.low_n_mm:.3g} to {stiffness.high_n_mm:.3g} at 95 %)"
    run.table(
        {
            "bending length": f"{stiffness.bending_length_mm:.1f} mm",
            "bending stiffness": f"{stiffness.n_mm:.3g} N mm{interval}",
        }
    )
    run.lines([f'in [fabric]: bending = "consistent", bending_stiffness_n_mm = {stiffness.n_mm:.3g}, modulus_mpa'])


def _overhang(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise Mistake(f"MM: must be overhangs in mm, or one table (.csv), not {text!r}") from None
