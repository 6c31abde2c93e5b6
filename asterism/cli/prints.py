"""Files for a print, and what is measured of prints: `asterism export`, `compare` and `strips`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

import asterism
from asterism.cli.command import (
    DONE,
    NO_ANSWER,
    DesignFile,
    FileUnit,
    LawFile,
    MaterialFile,
    Mistake,
    Run,
    command,
    nonempty_path,
    output_option,
    results_folder,
)
from asterism.process.environment import quoted
from asterism.process.settings import ExportSettings, StripFitSettings, StripPrintSettings


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
    from asterism.laws.from_files import with_material

    plan = with_material(
        asterism.load_design(design), material, run.warn
    )  # before slower imports: many mistakes are here

    from asterism.exact.cost import exact_cost
    from asterism.laws.from_files import law_from_file
    from asterism.print.export import check_shape_request, export_file_names
    from asterism.results.files import EXPORT_SUMMARY_FILE
    from asterism.verification.simulate import BOTH_STARTS

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
    from asterism.measure.compare import check_comparison_directory
    from asterism.measure.scan import check_file

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
    from asterism.measure.fit_strips import check_material_path
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
