"""`asterism preview`: the homogenised shape of a design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from asterism.cli.common.options import DesignFile, LawFile, MaterialFile, output_option, results_folder
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command


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

    chosen = read_design(design, material, run.warn)  # before slower imports: many mistakes are here

    from asterism.laws.design_law import law_from_file
    from asterism.previews.session import preview as compute
    from asterism.print.bed_placement import size_warning
    from asterism.reports.write_results import write_results
    from asterism.results.words import doubts

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
    run.table(shape.summary.table(), doubts=doubts(shape.summary))
    run.files(directory, files)
    warnings = shape.summary["warnings"]
    run.warn(*warnings, *size_warning(chosen))
    if warnings and not settle:
        run.warn("go on to the exact shape with --settle")
    return DONE if shape.summary["is_minimum"] else NO_ANSWER
