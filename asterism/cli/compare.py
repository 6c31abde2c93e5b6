"""The command `asterism compare`."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.options import output_option


class _Unit(StrEnum):
    mm = "mm"
    cm = "cm"
    m = "m"
    inches = "in"
    um = "um"


class _View(StrEnum):
    above = "above"
    front = "front"
    side = "side"


def compare(
    shape: Annotated[Path, typer.Argument(help="Results of simulate, preview or verify, or a shape.vtu.")],
    scan: Annotated[Path, typer.Argument(help="A scan (.obj, .stl, .ply) or a photographed outline (.svg, .csv).")],
    output: Annotated[Path | None, output_option("Directory (SCAN-compared).")] = None,
    units: Annotated[_Unit | None, typer.Option(help="Of the scan's numbers (mm).")] = None,
    view: Annotated[_View | None, typer.Option(help="From where an outline was photographed (above).")] = None,
    trim: Annotated[
        float, typer.Option(min=0.0, max=0.8, help="The part of the scan that may not belong to the sheet.")
    ] = 0.2,
) -> None:
    """How far a printed sheet is from its computed shape: the distance, with a picture.

    The scan is turned and shifted onto the shape, never mirrored or scaled. It may be of a part only.
    """
    from asterism.measure.compare.run import compare as run

    typer.echo("\n".join(run(shape, scan, output, units and units.value, view and view.value, trim)))
