"""`asterism law`: the content of a law."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.common.options import output_option
from asterism.cli.common.run import Run, command

app = typer.Typer(help="Show the content of a law.", no_args_is_help=True)


@command
def show(
    run: Run,
    path: Annotated[
        Path | None, typer.Argument(help="File of the law (.npz). Without a file: the law of the paper's material.")
    ] = None,
    output: Annotated[Path | None, output_option("Directory (default: the name of the law).")] = None,
) -> None:
    """Print a law as a table, and draw it with its errors in law.png."""
    from asterism.laws.show_law import show_law as show_law

    run.lines(show_law(path, output))


app.command()(show)
