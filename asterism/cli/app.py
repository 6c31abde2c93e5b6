"""The typer application with all commands of `asterism`."""

from __future__ import annotations

from typing import Annotated

import typer

from asterism.cli import law, strips
from asterism.cli.calibrate import calibrate
from asterism.cli.compare import compare
from asterism.cli.compare_designs import compare_designs
from asterism.cli.export import export
from asterism.cli.fit import fit
from asterism.cli.hops import hops
from asterism.cli.materials import materials
from asterism.cli.new import new
from asterism.cli.picture import picture
from asterism.cli.preview import preview
from asterism.cli.printers import printers
from asterism.cli.report import report
from asterism.cli.simulate import simulate
from asterism.cli.studio import studio
from asterism.cli.sweep import sweep
from asterism.cli.verify import verify
from asterism.process.version import __version__

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
for function in (
    *(new, studio, preview, simulate, verify, sweep, fit, export, picture, printers, compare),
    *(compare_designs, materials, report, calibrate, hops),
):
    app.command()(function)
app.add_typer(strips.app, name="strips")
app.add_typer(law.app, name="law")


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and stop.")] = False,
) -> None:
    """Compute the shape of plastic stars or lines printed on stretched fabric."""
    if version:
        typer.echo(__version__)
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())
