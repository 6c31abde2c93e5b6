"""The typer application with all commands of `asterism`."""

from __future__ import annotations

from typing import Annotated

import typer

from asterism.cli import lists, strips
from asterism.cli.lists import calibrate, materials, new, printers
from asterism.cli.options import group
from asterism.cli.pages import compare_designs, picture, report
from asterism.cli.prints import compare, export
from asterism.cli.servers import hops, studio
from asterism.cli.shapes import fit, preview, simulate, sweep, verify
from asterism.process.version import __version__

app = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
for function in (
    *(new, studio, preview, simulate, verify, sweep, fit, export, picture, printers, compare),
    *(compare_designs, materials, report, calibrate, hops),
):
    app.command()(function)
measure = (strips.new, strips.fit, strips.weigh, strips.overhang)
app.add_typer(group("Measure plastic and fabric with printed strips.", *measure), name="strips")
app.add_typer(group("Show a law, or forget the kept cells.", lists.show, lists.forget), name="law")


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
