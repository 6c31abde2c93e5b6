"""`asterism report`: a design on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import DesignFile, LawFile, MaterialFile, PlasticName, PrinterName, output_option
from asterism.cli.common.run import Run, command


@command
def report(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("File of the page (default: DESIGN-report.pdf).")] = None,
    results: Annotated[
        Path | None,
        typer.Option(
            help="Results of simulate, preview or verify (default: those beside the design, or a new preview)."
        ),
    ] = None,
    printer: PrinterName = "ultimaker2",
    plastic: PlasticName = "tpu95a",
    material: MaterialFile = None,
    law: LawFile = None,
) -> None:
    """Write one page about a design as PDF: parameters, picture, layout, needles, accuracy, material."""
    from asterism.laws.replace_material import read_design

    plan = read_design(design, material, run.warn)  # before slower imports: many mistakes are here

    from asterism.homogenize.errors import LawError
    from asterism.laws.design_law import law_from_file
    from asterism.reports.design_report import report as write

    if law and results:
        raise LawError("--law: is for a new preview, not with --results")
    path = output or design.with_name(f"{design.stem}-report.pdf")
    written = write(
        plan,
        path,
        results=results,
        beside=design.with_suffix(""),
        printer=printer,
        plastic=plastic,
        law=law_from_file(plan, law, design, material) if law else None,
        say=run.warn,
    )
    run.lines([f"{path}: layout 1:{written.scale:g}; shape: {written.source}"])
