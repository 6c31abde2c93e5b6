"""Laws of materials: `asterism calibrate` and `asterism law`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from asterism.cli.options import (
    DaskAddress,
    MaterialFile,
    Processes,
    check_ending,
    check_workers,
    output_option,
)
from asterism.cli.run import Run, command
from asterism.process.environment import quoted


@command
def calibrate(
    run: Run,
    file: Annotated[
        Path | None,
        typer.Argument(help="Material file with a plan, or a design. Without a file: the material of the paper."),
    ] = None,
    output: Annotated[
        Path | None,
        output_option("File of the law (default: MATERIAL.npz, DESIGN-law.npz or DESIGN-law-MATERIAL.npz)."),
    ] = None,
    material: MaterialFile = None,
    jobs: Processes = None,
    dask: DaskAddress = None,
) -> None:
    """Compute the law of a material from many unit cells, or of the stars or the motif of one design from a few.

    Cells are kept for all designs, so that an interrupted run continues and previews need no cell of it. The exit
    status is 1 if too many cells have no equilibrium, or no cell of a motif stands for its sheet.
    """
    from asterism.homogenize.campaign.kept_samples import cells_folder
    from asterism.homogenize.campaign.workers import default_jobs
    from asterism.laws import calibrate as calibration
    from asterism.laws.design_law import is_design, law_output_path, plan_from_file
    from asterism.laws.law_text import law_lines
    from asterism.pattern.design.errors import DesignError

    path = law_output_path(file, output, material)
    check_ending(path, ".npz")
    check_workers(jobs, dask)
    plan = plan_from_file(file, material, run.warn)
    line = " ".join(["asterism calibrate", *([file.name] if file else [])])
    line += f" --material {material.name}" if material else ""
    workers = jobs or default_jobs()
    try:
        with run.resumable(cells_folder(), "cells"):
            law = calibration.calibrate(plan, path, workers, dask, line, run.hand_over())
    except DesignError as error:
        raise error.within(material or file or "") from None
    run.lines([*law_lines(law), f"{path}: the law; its cells stay in {cells_folder()}"])
    if is_design(file):
        other = f" --material {quoted(material)}" if material else ""
        run.lines([f"now run  asterism preview {quoted(file)}{other} --law {quoted(path)}"])


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
