"""`asterism fit`: a design for a target surface."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from asterism.cli.options import FileUnit, LawFile, check_ending, output_option
from asterism.cli.run import DONE, INTERRUPTED, NO_ANSWER, Mistake, Run, command
from asterism.fitting.settings import FitSettings


@command
def fit(
    run: Run,
    target: Annotated[
        Path, typer.Argument(help="Target: .obj, .stl, .ply, .3dm, a grey picture, or heights as .npy or .csv.")
    ],
    output: Annotated[Path | None, output_option("Design file (default: TARGET.toml).")] = None,
    unit: Annotated[
        FileUnit | None, typer.Option(help="Unit of the numbers in the file (default: mm, or what a .3dm file names).")
    ] = None,
    size_mm: Annotated[
        float | None, typer.Option(min=1.0, help="Scale the target: largest distance of two of its points in mm.")
    ] = None,
    heights_mm: Annotated[
        tuple[float, float] | None, typer.Option(metavar="BLACK WHITE", help="Heights of black and white of a picture.")
    ] = None,
    extent_mm: Annotated[
        float | None, typer.Option(help="Width of a picture, or of heights in .npy or .csv, along x.")
    ] = None,
    side: Annotated[
        Literal["auto", "normals", "other"],
        typer.Option(help="Side of the plastic; auto: the convex one. normals: that of the file's normals."),
    ] = "auto",
    printer: Annotated[
        str, typer.Option(help="Printer to whose layers and lines sizes are rounded (see asterism printers).")
    ] = "ultimaker2",
    rounding: Annotated[
        bool, typer.Option("--rounding/--no-rounding", help="Round sizes to the layers and lines of the printer.")
    ] = True,
    weight: Annotated[
        str | None,
        typer.Option(
            metavar="FORMULA|PICTURE",
            help="Where to come nearer: a formula in x, y, z, r, theta (mm in the file), or a grey picture over the "
            "target as seen along z, black 1, white 10. Weights are from 0.01 to 100.",
        ),
    ] = None,
    law: LawFile = None,
    *,
    settings: FitSettings,
) -> int:
    """Find star sizes whose sheet comes near to a target surface.

    Writes the design file, and a folder beside it, DESIGN-fit, with report.html, summary.json, shape.vtu, shape.obj,
    rods.vtu and target.obj. The exit status is 1 if the shape is further from the target than --within, or
    is no minimum. If the command is interrupted, it writes the best design until then, and the exit status is 130.
    """
    from asterism.fitting.fit import FitInterrupted
    from asterism.fitting.fit import fit as compute
    from asterism.fitting.load_target import load_target
    from asterism.homogenize.law.law_file import load_law
    from asterism.homogenize.law.motif_law import MotifLaw
    from asterism.pattern.design.files import table_text
    from asterism.print.printer import load_printer
    from asterism.reports.fit_page import write_fit
    from asterism.results.files import check_writable, write_file

    file = output or target.with_suffix(".toml")
    check_ending(file, ".toml")
    directory = file.with_name(f"{file.stem}-fit")
    check_writable(file.parent, file.name)
    check_writable(directory)
    surface = load_target(target, unit, size_mm, side, heights_mm, extent_mm)
    run.warn(*surface.notes)
    if weight is not None:
        surface = surface.weighted(weight)
    chosen_printer = load_printer(printer) if rounding else None
    chosen_law = None if law is None else load_law(law)
    if isinstance(chosen_law, MotifLaw):
        raise Mistake(f"--law: {law} is the law of a motif, not of stars")
    try:
        with run.computing():
            fitted = compute(surface, settings, chosen_law, chosen_printer, run.say, run.report)
    except FitInterrupted as interruption:
        fitted = interruption.fitted
    files = write_fit(fitted, directory)
    write_file(file, table_text(fitted.design.to_dict(), file))
    run.table(fitted.summary.table())
    run.lines([str(file)])
    run.files(directory, files)
    run.warn(*fitted.summary.warnings)
    if fitted.summary.interrupted:
        return INTERRUPTED
    return DONE if fitted.summary.reached else NO_ANSWER
