"""`asterism law`: the content of a law."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import output_option
from asterism.cli.common.run import Run, command

app = typer.Typer(help="Show the content of a law.", invoke_without_command=True)


@app.callback()
def _needs_a_command(context: typer.Context) -> None:
    from asterism.cli.common.mistake import Mistake

    if context.invoked_subcommand is None:
        raise Mistake("law: needs a command, show")


@command
def show(
    run: Run,
    path: Annotated[
        Path | None, typer.Argument(help="File of the law (.npz). Without a file: the law of the paper's material.")
    ] = None,
    output: Annotated[Path | None, output_option("Directory (default: the name of the law).")] = None,
) -> None:
    """Print a law as a table, and draw it with its errors in law.png."""
    from asterism.laws.show_law import law_doubts, show_law

    lines = show_law(path, output)
    run.table({}, doubts=law_doubts(path))
    run.lines(lines)


app.command()(show)
