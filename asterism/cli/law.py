"""`asterism law`: the content of a law, and the kept cells."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import output_option
from asterism.cli.common.run import Mistake, Run, command

app = typer.Typer(
    help="Show a law, or forget the kept cells.",
    invoke_without_command=True,
)


@app.callback()
def _needs_a_command(context: typer.Context) -> None:
    if context.invoked_subcommand is None:
        raise Mistake("law: needs a command: show or forget")


@command
def show(
    run: Run,
    path: Annotated[
        Path | None, typer.Argument(help="File of the law (.npz). Without a file: the law of the paper's material.")
    ] = None,
    output: Annotated[Path | None, output_option("Directory (default: the name of the law).")] = None,
) -> None:
    """Print a law and its errors as tables, and draw it in law.png."""
    from asterism.laws.law_text import law_doubts, show_law

    lines = show_law(path, output)
    run.table({}, doubts=law_doubts(path))
    run.lines(lines)


@command
def forget(run: Run) -> None:
    """Remove the cells that previews and calibrations have kept on this machine."""
    from asterism.homogenize.campaign.kept_samples import cells_folder, forget_oldest

    folder = cells_folder()
    run.lines([f"{forget_oldest(folder, 0)} cells removed from {folder}"])


for function in (show, forget):
    app.command()(function)
