"""`asterism sweep`: many variants of one design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.options import (
    DaskAddress,
    DesignFile,
    LawFile,
    MaterialFile,
    Processes,
    check_workers,
    output_option,
    results_folder,
)
from asterism.cli.run import NO_ANSWER, Mistake, Run, command


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
    seed: Annotated[int, typer.Option(min=0, help="Seed of the Latin hypercube.")] = 0,
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
    from asterism.homogenize.law.law_file import load_law
    from asterism.laws.replace_material import read_design
    from asterism.process.progress_line import CountLine
    from asterism.results.files import check_folder
    from asterism.sweeps.cost import sweep_cost
    from asterism.sweeps.parameters import SweepParameter
    from asterism.sweeps.sweep import check_model, sampled, sweep_design, sweep_parameters, write_sweep

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
    count = len(sampled(parameters, samples, seed))
    run.cost(sweep_cost(chosen, parameters, count, exact, jobs or default_jobs(), law is not None))
    own_law = load_law(law) if law else None
    with run.resumable(folder, "designs"):
        with CountLine("designs", run.hand_over()) as progress:
            result = sweep_design(
                chosen,
                parameters,
                exact=exact,
                samples=samples,
                seed=seed,
                folder=folder,
                jobs=jobs,
                dask=dask,
                law=own_law,
                report=progress.report,
            )
        files = write_sweep(result, directory)
    run.result(result.summary, directory, files, result.doubts)
    if result.failed < len(result.points):
        return 0
    run.warn("no design has a shape; the column problem of sweep.csv has the reasons")
    return NO_ANSWER
