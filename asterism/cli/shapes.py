"""Shapes of a design, of its variants, and designs for a shape: `asterism preview` to `verify`, `sweep` and `fit`."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

import asterism
from asterism.cli.command import (
    DONE,
    INTERRUPTED,
    NO_ANSWER,
    BackendOption,
    Contact,
    DaskAddress,
    DesignFile,
    EdgeOption,
    FileUnit,
    LawFile,
    MaterialFile,
    Mistake,
    Processes,
    Run,
    ToleranceOption,
    check_workers,
    command,
    output_option,
    results_folder,
    with_overrides,
)
from asterism.process.settings import FitSettings

# Designs are read before slower imports: many mistakes are there.


@command
def preview(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    law: LawFile = None,
    side: Annotated[
        Literal["auto", "up", "down"],
        typer.Option(help="Side to which the edges bend; auto: the side follows from the stars."),
    ] = "auto",
    material: MaterialFile = None,
    settle: Annotated[bool, typer.Option(help="Go on to the exact shape that the preview leads to.")] = False,
) -> int:
    """Compute the fast preview of a design: a smooth sheet with the corrugation of the stars, or with the rods of a
    motif. With --settle the exact model goes on from there.

    Writes summary.json, shape.vtu, rods.vtu, shape.obj and shape.png. The exit status is 1 if no minimum was found.
    """
    from asterism.laws.from_files import read_design

    chosen = read_design(design, material, run.warn)

    from asterism.laws.from_files import law_from_file
    from asterism.print.bed_placement import size_warning

    directory = results_folder(design, output, design.with_suffix(""))
    chosen_law = law_from_file(chosen, law, design, material)
    if settle:
        from asterism.exact.cost import exact_cost

        run.cost(exact_cost(chosen))
    with run.computing(compile_ahead="discrete" if settle else None):
        shape = asterism.preview(chosen, chosen_law, side, run.say)
        if settle:
            from asterism.exact.simulation import exact_shape

            shape = exact_shape(chosen, report=run.report, say=run.say, near=shape)
        files = asterism.write_results(shape, directory)
    run.result(shape.summary, directory, files)
    warnings = shape.summary["warnings"]
    run.warn(*warnings, *size_warning(chosen))
    if warnings and not settle:
        run.warn("go on to the exact shape with --settle")
    return DONE if shape.summary["is_minimum"] else NO_ANSWER


@command
def simulate(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    edge: EdgeOption = None,
    tolerance: ToleranceOption = None,
    starts: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1000,
            help="Number of initial guesses; 1 is the released flat print alone (default: that and the preview). The "
            "result is the lowest minimum with all stars on the prescribed side.",
        ),
    ] = None,
    spread: Annotated[
        bool,
        typer.Option(
            "--spread", help="Also compute the range of shapes that prints may have, by the intervals of [spread]."
        ),
    ] = False,
    law: LawFile = None,
    contact: Contact = None,
    material: MaterialFile = None,
    backend: BackendOption = "auto",
) -> int:
    """Compute the exact shape of a design, and certify that it is an equilibrium.

    The flat print is released, and the preview is a second start. Writes summary.json, shape.vtu, rods.vtu,
    shape.obj and shape.png, and minimum-2.vtu, minimum-2.png and so on, one pair for each further minimum. With
    --spread also spread.png. The exit status is 1 if no minimum was found.
    """
    from asterism.laws.from_files import read_design

    read = read_design(design, material, run.warn)

    from asterism.discrete.energies.contact import ipc_toolkit
    from asterism.equilibrium.linear.backends import check_backend
    from asterism.exact.cost import exact_cost
    from asterism.exact.spread import MAX_SOLVES, check_spread
    from asterism.laws.from_files import law_from_file
    from asterism.pattern.layout.build import layout
    from asterism.verification.simulate import BOTH_STARTS

    changed = with_overrides(read, edge=edge, tolerance=tolerance, contact=contact)
    # what is missing is said before anything else
    check_backend(backend)
    if changed.solver.contact:
        ipc_toolkit()
    if spread:
        check_spread(changed, layout(changed))
    given_law = law_from_file(changed, law, design, material) if law is not None else None
    directory = results_folder(design, output, design.with_suffix(""))
    default_starts = BOTH_STARTS if changed.rods is None else 1
    # from a shape nearby, an end of an interval costs about as much as a further start
    all_starts = (default_starts if starts is None else starts) + spread * (MAX_SOLVES - 1)
    run.cost(exact_cost(changed, all_starts))
    with run.computing(compile_ahead="fem" if starts is None and changed.rods is None else None):
        shape = asterism.simulate(changed, backend, run.report, run.say, starts, law=given_law)
        if spread and shape.summary["is_minimum"]:
            shape = asterism.spread(shape, backend, run.report, run.say)
        files = asterism.write_results(shape, directory)
    run.result(shape.summary, directory, files)
    run.warn(*shape.summary["warnings"])
    if spread and not shape.summary["is_minimum"]:
        run.warn("--spread: no range of shapes was computed, because this one is not stable")
    if given_law is not None and changed.rods is not None:
        run.warn("--law is not used: drawn rods start from the flat print alone; asterism verify takes the law")
    return DONE if shape.summary["is_minimum"] else NO_ANSWER


@command
def verify(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the report (DESIGN-verified).")] = None,
    law: LawFile = None,
    edge: EdgeOption = None,
    tolerance: ToleranceOption = None,
    contact: Contact = None,
    material: MaterialFile = None,
    backend: BackendOption = "auto",
) -> int:
    """Compare the preview of a design with its exact shape.

    Writes report.html, summary.json, exact.vtu and preview.vtu. The exit status is 1 if the exact model finds no
    minimum.
    """
    from asterism.laws.from_files import read_design

    read = read_design(design, material, run.warn)

    from asterism.equilibrium.linear.backends import check_backend
    from asterism.exact.cost import exact_cost
    from asterism.laws.from_files import law_from_file

    chosen = with_overrides(read, edge=edge, tolerance=tolerance, contact=contact)
    check_backend(backend)
    # a folder of its own: simulate and preview write to a folder with the design's name
    directory = results_folder(design, output, design.with_name(f"{design.stem}-verified"))
    chosen_law = law_from_file(chosen, law, design, material)  # check the law before the computation
    run.cost(exact_cost(chosen, shapes=2))
    with run.computing(compile_ahead="discrete"):
        line = shlex.join(["asterism", *sys.argv[1:]])
        verification = asterism.verify(chosen, chosen_law, backend, run.report, run.say, command=line)
        run.say("writing the report")
        files = asterism.write_verification(verification, directory)
    run.result(verification.summary, directory, files)
    run.warn(*verification.summary["warnings"])
    return DONE if verification.summary["exact"]["is_minimum"] else NO_ANSWER


@command
def sweep(
    run: Run,
    design: DesignFile,
    vary: Annotated[
        list[str],
        typer.Option(
            help="Entry of the design and its values: stars.thickness_mm=0.2:0.6:9 for nine equally spaced values, "
            "pins.0.scale=0.7,0.8 for a list; can be given several times."
        ),
    ],
    output: Annotated[Path | None, output_option("Directory of the results (default: DESIGN-sweep).")] = None,
    exact: Annotated[bool, typer.Option("--exact", help="Compute exact shapes, not previews.")] = False,
    samples: Annotated[
        int | None,
        typer.Option(help="Designs of a Latin hypercube, instead of all combinations; then FROM:TO is a range."),
    ] = None,
    jobs: Processes = None,
    dask: DaskAddress = None,
    law: LawFile = None,
    material: MaterialFile = None,
) -> int:
    """Compute many variants of a design: a table, and a page with pictures and plots that sorts and filters.

    Writes sweep.html, sweep.csv and summary.json. A design that fails is a row with its reason. The command continues
    an interrupted sweep: finished designs are in the folder designs of the directory. The exit status is 1 if no design
    has a shape.
    """
    from asterism.homogenize.campaign.workers import default_jobs
    from asterism.laws.from_files import read_design
    from asterism.process.progress import CountLine
    from asterism.results.files import check_folder
    from asterism.sweeps.parameters import SweepParameter
    from asterism.sweeps.point import sweep_cost
    from asterism.sweeps.sweep import check_model, sampled, sweep_parameters

    check_workers(jobs, dask)
    if exact and law is not None:
        raise Mistake("--law: is for previews, not with --exact")
    chosen = read_design(design, material, run.warn)
    given = [SweepParameter.from_text(text) for text in vary]
    check_model(chosen, exact)
    parameters = sweep_parameters(chosen, given)
    directory = results_folder(design, output, design.with_name(f"{design.stem}-sweep"))
    folder = directory / "designs"
    check_folder(folder)
    count = len(sampled(parameters, samples))
    run.cost(sweep_cost(chosen, parameters, count, exact, jobs or default_jobs(), law is not None))
    own_law = asterism.load_law(law) if law else None
    with run.resumable(folder, "designs"):
        with CountLine("designs", run.hand_over()) as progress:
            result = asterism.sweep(
                chosen,
                parameters,
                exact=exact,
                samples=samples,
                folder=folder,
                jobs=jobs,
                dask=dask,
                law=own_law,
                report=progress.report,
            )
        files = asterism.write_sweep(result, directory)
    run.result(result.summary, directory, files, result.doubts)
    if result.failed < len(result.points):
        return 0
    run.warn("no design has a shape; the column problem of sweep.csv has the reasons")
    return NO_ANSWER


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
    from asterism.homogenize.law.motif_law import MotifLaw
    from asterism.pattern.design.files import table_text
    from asterism.print.printer import load_printer
    from asterism.results.files import check_file, check_writable, write_file

    file = output or target.with_suffix(".toml")
    directory = file.with_name(f"{file.stem}-fit")
    check_file(file, ".toml")
    check_writable(directory)
    surface = asterism.load_target(target, unit, size_mm, side, heights_mm, extent_mm)
    run.warn(*surface.notes)
    if weight is not None:
        surface = surface.weighted(weight)
    chosen_printer = load_printer(printer)
    chosen_law = None if law is None else asterism.load_law(law)
    if isinstance(chosen_law, MotifLaw):
        raise Mistake(f"--law: {law} is the law of a motif, not of stars")
    try:
        with run.computing():
            fitted = asterism.fit(surface, settings, chosen_law, chosen_printer, run.say, run.report)
    except FitInterrupted as interruption:
        fitted = interruption.fitted
    files = asterism.write_fit(fitted, directory)
    write_file(file, table_text(fitted.design.to_dict(), file))
    run.table(fitted.summary.table())
    run.lines([str(file)])
    run.files(directory, files)
    run.warn(*fitted.summary.warnings)
    if fitted.summary.interrupted:
        return INTERRUPTED
    return DONE if fitted.summary.reached else NO_ANSWER
