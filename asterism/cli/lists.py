"""What asterism comes with, and your own: `asterism new`, `printers`, `materials`, `calibrate` and `law`."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any

import typer

import asterism
from asterism.cli.command import (
    DONE,
    WRONG_INPUT,
    DaskAddress,
    MaterialFile,
    Mistake,
    Processes,
    Run,
    check_workers,
    command,
    output_option,
)
from asterism.process.environment import quoted


@command
def new(
    run: Run,
    name: Annotated[
        str | None,
        typer.Argument(help="Name of a template or a design. Without a name, the command lists all of them."),
    ] = None,
    output: Annotated[Path | None, output_option("File of the design (default: NAME.toml).")] = None,
) -> None:
    """Write a template, a design of the paper's figures, or a drawn pattern, to a file that you can change."""
    from asterism.pattern import gallery
    from asterism.results.files import check_file, write_file

    lists = {
        "templates": gallery.template_names(),
        "figures of the paper": gallery.names(),
        "drawn patterns": gallery.pattern_names(),
    }
    if name is None:
        for title, names in lists.items():
            run.lines([f"{title}:"])
            run.table({each: gallery.words(each) for each in names}, width=24)
        return
    known = [each for names in lists.values() for each in names]
    if name not in known:
        raise Mistake(f"NAME: {name!r} is not in the gallery; there are {', '.join(known)}")
    path = output or Path(f"{name}.toml")
    check_file(path, ".toml")
    content = gallery.path(name).read_bytes()
    if path.exists() and not (path.is_file() and path.read_bytes() == content):
        raise Mistake(f"--output: {str(path)!r} exists and is kept; choose another name")
    write_file(path, content)
    where = quoted(path)
    following = f"asterism preview {where}  for its shape at once, or  asterism verify {where}"
    if name in lists["drawn patterns"] and "motif" not in tomllib.loads(content.decode())["rods"]:
        following = f"asterism simulate {where}  for its shape, or  asterism export {where}  for the print"
    run.lines([f"{path}: run  {following}"])


@command
def printers(run: Run) -> int:
    """List printers and plastics, and the folders of your own profiles.

    The exit status is 2 if one of your files is wrong; the list contains the others.
    """
    from asterism.pattern.design.errors import DesignError
    from asterism.pattern.design.files import PROFILES_VARIABLE, own_folders
    from asterism.print.printer import load_plastic, load_printer, readable_profiles

    errors: list[DesignError] = []
    for name, printer in readable_profiles("printers", load_printer, errors.append):
        run.table({name: _of_printer(printer)}, width=14)
    for name, plastic in readable_profiles("plastics", load_plastic, errors.append):
        run.table({name: plastic.name}, width=14)
    wrong = [" ".join(str(error).split()) for error in errors]
    own = " or ".join(map(str, own_folders()))
    run.lines([f"yours: printers/NAME.toml and plastics/NAME.toml in {own} ({PROFILES_VARIABLE})"])
    run.lines(
        [
            "their start codes are not complete: they set the height of the fabric, and leave temperatures, homing, "
            "purging and the end to your slicer"
        ]
    )
    run.warn(*wrong)
    return WRONG_INPUT if wrong else DONE


def _of_printer(machine: Any) -> str:
    width, depth = machine.bed_mm
    layers = " or ".join(f"{height:g}" for height in machine.first_layers_mm)
    return f"{machine.name}: {width:g} x {depth:g} mm, layers {layers} + n {machine.layer_mm:g} mm"


@command
def materials(run: Run) -> int:
    """List measured materials, which all commands take by name, and the folders of your own.

    The exit status is 2 if one of your files is wrong; the list contains the others.
    """
    from asterism.laws.from_files import material_in_words
    from asterism.pattern.design.errors import DesignError
    from asterism.pattern.design.files import PROFILES_VARIABLE, own_folders
    from asterism.pattern.design.material_files import MATERIALS_FOLDER, material_files

    wrong = []
    for name, path in material_files().items():
        try:
            run.table({name: material_in_words(path)}, width=14)
        except DesignError as error:
            wrong.append(str(error))
    own = " or ".join(str(folder / MATERIALS_FOLDER) for folder in own_folders())
    run.lines([f"yours: NAME.toml in {own} ({PROFILES_VARIABLE}); asterism strips fit --save NAME writes one"])
    run.warn(*wrong)
    return WRONG_INPUT if wrong else DONE


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
    from asterism.laws.from_files import is_design, law_output_path, plan_from_file
    from asterism.laws.law import law_lines
    from asterism.pattern.design.errors import DesignError
    from asterism.results.files import check_file

    path = law_output_path(file, output, material)
    check_file(path, ".npz")
    check_workers(jobs, dask)
    plan = plan_from_file(file, material, run.warn)
    line = " ".join(["asterism calibrate", *([file.name] if file else [])])
    line += f" --material {material.name}" if material else ""
    workers = jobs or default_jobs()
    try:
        with run.resumable(cells_folder(), "cells"):
            law = asterism.calibrate(plan, path, workers, dask, line, run.hand_over())
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
    from asterism.laws.law import held_out_warning

    lines = asterism.show_law(path, output)
    doubt = held_out_warning(asterism.load_law(path))
    run.table({}, doubts=[doubt] if doubt else [])
    run.lines(lines)


@command
def forget(run: Run) -> None:
    """Remove the cells that previews and calibrations have kept on this machine."""
    from asterism.homogenize.campaign.kept_samples import cells_folder, forget_oldest

    folder = cells_folder()
    run.lines([f"{forget_oldest(folder, 0)} cells removed from {folder}"])
