"""The shapes of a design: `asterism preview`, `simulate` and `verify`."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from asterism.cli.options import (
    BackendOption,
    Contact,
    DesignFile,
    EdgeOption,
    LawFile,
    MaterialFile,
    ToleranceOption,
    output_option,
    results_folder,
    with_overrides,
)
from asterism.cli.run import DONE, NO_ANSWER, Run, command

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
    from asterism.laws.replace_material import read_design

    chosen = read_design(design, material, run.warn)

    from asterism.laws.design_law import law_from_file
    from asterism.previews.session import preview as compute
    from asterism.print.bed_placement import size_warning
    from asterism.reports.write_results import write_results

    directory = results_folder(design, output, design.with_suffix(""))
    chosen_law = law_from_file(chosen, law, design, material)
    if settle:
        from asterism.exact.cost import exact_cost

        run.cost(exact_cost(chosen))
    with run.computing(compile_ahead="discrete" if settle else None):
        shape = compute(chosen, chosen_law, side, run.say)
        if settle:
            from asterism.exact.simulation import exact_shape

            shape = exact_shape(chosen, report=run.report, say=run.say, near=shape)
        files = write_results(shape, directory)
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
    seed: Annotated[
        int | None, typer.Option(help="Seed of the initial guess's noise, instead of the value in the design.")
    ] = None,
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
    from asterism.laws.replace_material import read_design

    read = read_design(design, material, run.warn)

    from asterism.discrete.energies.contact import ipc_toolkit
    from asterism.equilibrium.linear.backends import check_backend
    from asterism.exact.cost import exact_cost
    from asterism.exact.spread import MAX_SOLVES, check_spread
    from asterism.exact.spread import spread as with_spread
    from asterism.laws.design_law import law_from_file
    from asterism.pattern.layout.build import layout
    from asterism.reports.write_results import write_results
    from asterism.verification.both_starts import BOTH_STARTS
    from asterism.verification.both_starts import simulate as compute

    changed = with_overrides(read, edge=edge, tolerance=tolerance, seed=seed, contact=contact)
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
        shape = compute(changed, backend, run.report, run.say, starts, law=given_law)
        if spread and shape.summary["is_minimum"]:
            shape = with_spread(shape, backend, run.report, run.say)
        files = write_results(shape, directory)
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
    from asterism.laws.replace_material import read_design

    read = read_design(design, material, run.warn)

    from asterism.equilibrium.linear.backends import check_backend
    from asterism.exact.cost import exact_cost
    from asterism.laws.design_law import law_from_file
    from asterism.reports.verification_page import write_verification
    from asterism.verification.run import verify as compute

    chosen = with_overrides(read, edge=edge, tolerance=tolerance, contact=contact)
    check_backend(backend)
    # a folder of its own: simulate and preview write to a folder with the design's name
    directory = results_folder(design, output, design.with_name(f"{design.stem}-verified"))
    chosen_law = law_from_file(chosen, law, design, material)  # check the law before the computation
    run.cost(exact_cost(chosen, shapes=2))
    with run.computing(compile_ahead="discrete"):
        line = shlex.join(["asterism", *sys.argv[1:]])
        verification = compute(chosen, chosen_law, backend, run.report, run.say, command=line)
        run.say("writing the report")
        files = write_verification(verification, directory)
    run.result(verification.summary, directory, files)
    run.warn(*verification.summary["warnings"])
    return DONE if verification.summary["exact"]["is_minimum"] else NO_ANSWER
