"""`asterism law`: the content of a law, and the unit cell of a motif."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.errors import Mistake
from asterism.cli.common.options import output_option
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command

app = typer.Typer(
    help="Show a law, or solve the cell of a motif.",
    invoke_without_command=True,
)


@app.callback()
def _needs_a_command(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        raise Mistake("law: needs a command: show or cell")


@command
def show(
    run: Run,
    path: Annotated[
        Path | None, typer.Argument(help="File of the law (.npz). Without a file: the law of the paper's material.")
    ] = None,
    output: Annotated[Path | None, output_option("Directory (default: the name of the law).")] = None,
) -> None:
    """Print a law and its errors as tables, and draw it in law.png."""
    from asterism.laws.show_law import law_doubts, show_law

    lines = show_law(path, output)
    run.table({}, doubts=law_doubts(path))
    run.lines(lines)


@command
def cell(
    run: Run,
    file: Annotated[Path, typer.Argument(help="Design with a motif, [[rods.motif]].")],
    edge: Annotated[
        float | None, typer.Option(min=0.1, max=100.0, help="Edges of the cell's mesh, mm (default: of the design).")
    ] = None,
) -> int:
    """Solve the unit cell of a motif: rest metric, stiffness and natural curvatures of an endless sheet.

    The exit status is 1 if one cell does not stand for the sheet, which a cell of 2 x 2 motifs decides.
    """
    from asterism.laws.motif_cell import motif_cell, motif_cell_rows
    from asterism.pattern.design.errors import DesignError

    try:
        with run.computing():
            responses = motif_cell(file, edge, run.say)
    except DesignError as error:
        raise error.within(file) from None
    run.table(motif_cell_rows(responses), doubts=responses.doubts)
    return DONE if responses.comparison.has_law else NO_ANSWER


for function in (show, cell):
    app.command()(function)
