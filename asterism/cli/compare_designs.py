"""`asterism compare-designs`: several designs on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import LawFile, MaterialFile, PlasticName, PrinterName, output_option
from asterism.cli.common.run import Mistake, Run, command

# characters of the widest label and of a number in the table on the terminal
LABEL_WIDTH = 50
CELL_WIDTH = 20


@command
def compare_designs(
    run: Run,
    designs: Annotated[list[Path], typer.Argument(help="Design files (.toml or .json), 2 to 12.")],
    output: Annotated[Path | None, output_option("File of the page (default: A-B-C.html beside the first).")] = None,
    exact: Annotated[bool, typer.Option("--exact", help="Compute exact shapes, not previews.")] = False,
    printer: PrinterName = "ultimaker2",
    plastic: PlasticName = "tpu95a",
    law: LawFile = None,
    material: MaterialFile = None,
) -> None:
    """Write one page with several designs: pictures at one scale, sizes, print times, estimated errors, differences.

    Differences are those from the first design. A design without a shape is on the page with the reason.
    """
    from asterism.exact.cost import exact_cost
    from asterism.homogenize.law.law_file import load_law
    from asterism.laws.replace_material import read_design
    from asterism.reports.compare_designs import MAX_COMPARED_DESIGNS
    from asterism.reports.compare_designs import compare_designs as write
    from asterism.results.words import table_lines

    if not 2 <= len(designs) <= MAX_COMPARED_DESIGNS:
        raise Mistake(f"must be 2 to {MAX_COMPARED_DESIGNS} design files, not {len(designs)}")
    if exact and law is not None:
        raise Mistake("--law: is for previews, not with --exact")
    plans = [read_design(file, material, run.warn) for file in designs]
    stems = [file.stem for file in designs]
    path = output or designs[0].with_name("-".join(dict.fromkeys(stems)) + ".html")
    own_law = load_law(law) if law else None
    if exact:
        run.cost(exact_cost(max(plans, key=lambda plan: exact_cost(plan).seconds), shapes=len(plans)))
    with run.computing():
        written = write(
            plans,
            path,
            names=stems,
            exact=exact,
            printer=printer,
            plastic=plastic,
            law=own_law,
            say=run.say,
        )
    run.lines(table_lines({"": "  ".join(f"{each.name:>{CELL_WIDTH}}" for each in written.designs)}, LABEL_WIDTH))
    rows = {row.label: "  ".join(f"{text:>{CELL_WIDTH}}" for text in row.texts) for row in written.numbers}
    run.lines(table_lines(rows, LABEL_WIDTH))
    count = len(written.differences)
    run.lines([f"{path}: {count} {'entry differs' if count == 1 else 'entries differ'}"])
    run.warn(*(f"{each.name}: {each.problem}" for each in written.designs if each.problem))
