"""`asterism simulate`: the exact shape of a design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import (
    BackendOption,
    Contact,
    DesignFile,
    LawFile,
    MaterialFile,
    ToleranceOption,
    output_option,
    results_folder,
    with_overrides,
)
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command


@command
def simulate(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    edge: Annotated[
        float | None, typer.Option(help="Edge length of the mesh in mm, instead of the value in the design.")
    ] = None,
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

    read = read_design(design, material, run.warn)  # before slower imports: many mistakes are here

    from asterism.discrete.energies.contact import ipc_toolkit
    from asterism.equilibrium.linear.backends import check_backend
    from asterism.exact.cost import exact_cost
    from asterism.exact.spread import MAX_SOLVES, check_spread
    from asterism.exact.spread import spread as with_spread
    from asterism.laws.design_law import law_from_file
    from asterism.pattern.layout.build import layout
    from asterism.reports.write_results import write_results
    from asterism.results.words import doubts
    from asterism.verification.both_starts import BOTH_STARTS
    from asterism.verification.both_starts import simulate as compute

    changed = with_overrides(
        read,
        {
            "--edge": ("mesh.edge_mm", edge),
            "--tolerance": ("mesh.tolerance_percent", tolerance),
            "--seed": ("solver.seed", seed),
            "--contact": ("solver.contact", contact),
        },
    )
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
    run.table(shape.summary.table(), doubts=doubts(shape.summary))
    run.files(directory, files)
    run.warn(*shape.summary["warnings"])
    if spread and not shape.summary["is_minimum"]:
        run.warn("--spread: no range of shapes was computed, because this one is not stable")
    if given_law is not None and changed.rods is not None:
        run.warn("--law is not used: drawn rods start from the flat print alone; asterism verify takes the law")
    return DONE if shape.summary["is_minimum"] else NO_ANSWER
