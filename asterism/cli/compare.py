"""`asterism compare`: a printed sheet compared with its shape."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from asterism.cli.common.options import FileUnit, output_option
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command


@command
def compare(
    run: Run,
    shape: Annotated[Path, typer.Argument(help="Results of simulate, preview or verify, or a shape.vtu.")],
    scan: Annotated[Path, typer.Argument(help="A scan (.obj, .stl, .ply) or a photographed outline (.svg, .csv).")],
    output: Annotated[Path | None, output_option("Directory (default: SCAN-compared).")] = None,
    units: Annotated[FileUnit | None, typer.Option(help="Unit of the numbers in the file (default: mm).")] = None,
    view: Annotated[
        Literal["above", "front", "side"] | None,
        typer.Option(help="Direction of the photograph of an outline (default: above)."),
    ] = None,
    trim: Annotated[
        float, typer.Option(min=0.0, max=0.8, help="Largest part of the scan that does not belong to the sheet.")
    ] = 0.2,
) -> int:
    """Measure and draw the distance of a printed sheet from its computed shape.

    The scan is rotated and shifted onto the shape, but not mirrored or scaled. It may cover a part of the sheet.
    The exit status is 1 if the scan fits nowhere.
    """
    from asterism.measure.compare.compare import check_comparison_directory, write_comparison
    from asterism.measure.compare.compare import compare as measure
    from asterism.measure.compare.scan import check_file

    check_file(scan)
    directory = output or scan.with_name(f"{scan.stem}-compared")
    check_comparison_directory(directory, shape)
    with run.computing():
        comparison = measure(shape, scan, units=units, view=view, trim=trim)
        files = write_comparison(comparison, directory)
    run.table(comparison.rows, 22)
    run.files(directory, files)
    if not comparison.is_fit:
        percent = comparison.summary.rms_percent
        run.warn(f"{scan} fits nowhere, it is {percent:.0f} % of the diameter off (rms): is it of this design?")
    return DONE if comparison.is_fit else NO_ANSWER
