"""`asterism verify`: the preview compared with the exact model."""

from __future__ import annotations

import shlex
import sys
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
def verify(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the report (DESIGN-verified).")] = None,
    law: LawFile = None,
    edge: Annotated[
        float | None, typer.Option(help="Edge length of the exact mesh in mm, instead of the value in the design.")
    ] = None,
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

    read = read_design(design, material, run.warn)  # before slower imports: many mistakes are here

    from asterism.equilibrium.linear.backends import check_backend
    from asterism.exact.cost import exact_cost
    from asterism.laws.design_law import law_from_file
    from asterism.reports.verification_page import write_verification
    from asterism.results.words import doubts
    from asterism.verification.run import verify as compute

    chosen = with_overrides(
        read,
        {
            "--edge": ("mesh.edge_mm", edge),
            "--tolerance": ("mesh.tolerance_percent", tolerance),
            "--contact": ("solver.contact", contact),
        },
    )
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
    run.table(verification.summary.table(), doubts=doubts(verification.summary))
    run.files(directory, files)
    run.warn(*verification.summary["warnings"])
    return DONE if verification.summary["exact"]["is_minimum"] else NO_ANSWER
