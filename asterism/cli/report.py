"""`asterism report`: a design on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import DesignFile, LawFile, MaterialFile, output_option
from asterism.cli.common.run import Run, command


@command
def report(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("The page (DESIGN-report.pdf).")] = None,
    results: Annotated[
        Path | None, typer.Option(help="Results of simulate or preview (those beside the design, or a new preview).")
    ] = None,
    printer: Annotated[str, typer.Option(help="A printer by name, or its file; see asterism printers.")] = "ultimaker2",
    plastic: Annotated[str, typer.Option(help="A plastic by name, or its file.")] = "tpu95a",
    material: MaterialFile = None,
    law: LawFile = None,
) -> None:
    """Write one page about a design as PDF: parameters, picture, layout, needles, accuracy, material."""
    from asterism.laws.material import read_design
    from asterism.laws.own_law import law_for
    from asterism.print.job import prepare
    from asterism.print.profiles import load_plastic, load_printer
    from asterism.reports.design_page import write_design_page
    from asterism.reports.design_shape import shape_for_report
    from asterism.reports.facts import design_facts
    from asterism.results.files import OutputError, check_writable, staged
    from homogenize.errors import LawError

    if law and results:
        raise LawError("--law: is for a new preview, not with --results")
    plan = read_design(design, material)
    path = output or design.with_name(f"{design.stem}-report.pdf")
    if path.suffix.lower() != ".pdf":
        raise OutputError(f"--output: {str(path)!r} must end with .pdf")
    check_writable(path.parent, path.name)
    machine, profile = load_printer(printer), load_plastic(plastic)
    prepare(plan, machine, profile, any_size=True)  # before anything is computed: most mistakes are found here
    sheet = law_for(plan, law, design, material) if law else None
    shape, source = shape_for_report(plan, results, design.with_suffix(""), run.warn, sheet)
    job = prepare(plan, machine, profile, shape=shape, any_size=True)
    with staged(path.parent) as folder:
        summary = shape.summary if shape else {}
        parts = write_design_page(
            folder / path.name, job, design_facts(job, summary, source), summary.get("warnings", []), shape
        )
    run.lines([f"{path}: layout 1:{parts:g}; shape: {source}"])
