"""`asterism preview`: the homogenised shape of a design."""

from __future__ import annotations

from pathlib import Path
from shlex import join
from typing import Annotated, Literal

import typer

from asterism.cli.common.errors import Mistake
from asterism.cli.common.options import DesignFile, LawFile, MaterialFile, output_option, results_folder
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command


@command
def preview(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    law: LawFile = None,
    side: Annotated[
        Literal["auto", "up", "down"],
        typer.Option(help="Side to which the edges bend; auto: the side follows from the stars."),
    ] = "auto",
    material: MaterialFile = None,
    edge: Annotated[
        str | None,
        typer.Option(
            help="Edge length in mm of the exact mesh that the preview goes with, or limit for an infinitely fine "
            "mesh (default: that of the law)."
        ),
    ] = None,
) -> int:
    """Compute the fast preview of a design: a smooth sheet with the corrugation of the stars, or with the rods of a
    motif.

    With --edge the preview also states what an infinitely fine mesh would change.

    Writes summary.json, shape.vtu, rods.vtu, shape.obj and shape.png. The exit status is 1 if no minimum was found.
    """
    from asterism.laws.replace_material import read_design

    chosen = read_design(design, material, run.warn)  # before slower imports: many mistakes are here

    from asterism.homogenize.law.law import Law
    from asterism.laws.design_law import any_law_for_design
    from asterism.previews.run import preview as compute
    from asterism.print.bed_placement import size_warning
    from asterism.reports.write_results import write_results
    from asterism.results.words import doubts
    from asterism.verification.mesh_limit import design_and_law, with_mesh_limit

    directory = results_folder(design, output, design.with_suffix(""))
    chosen_law = any_law_for_design(chosen, law, design, material)
    asked = None if edge is None else _edge_mm(edge)
    on_mesh = chosen_law
    if asked is not None:
        if not isinstance(chosen_law, Law):
            raise Mistake("--edge: is for laws of stars; mesh.edge_mm is that of the cells of a motif")
        chosen, on_mesh = design_and_law(chosen, chosen_law, asked)
    with run.computing():
        shape = compute(chosen, on_mesh, side, run.say)
        if isinstance(chosen_law, Law) and asked is not None:
            shape = with_mesh_limit(shape, chosen, chosen_law)
        files = write_results(shape, directory)
    run.table(shape.summary.table(), doubts=doubts(shape.summary))
    run.files(directory, files)
    warnings = shape.summary["warnings"]
    run.warn(*warnings, *size_warning(chosen))
    if warnings and side != "auto":
        run.warn(
            "asterism verify checks the form of --side auto; check this one in Python: "
            "asterism.simulate(design, near=shape)"
        )
    elif warnings:
        run.warn(f"check with the exact model:  {_check_command(design, law, material, edge)}")
    return DONE if shape.summary["is_minimum"] else NO_ANSWER


def _check_command(design: Path, law: Path | None, material: Path | None, edge: str | None) -> str:
    """The command that compares a preview of these options with the exact shape.

    >>> _check_command(Path("dome.toml"), None, None, "0.7")
    'asterism verify dome.toml --edge 0.7'
    """
    # no exact mesh is infinitely fine: the design's own is taken
    options = {"--law": law, "--material": material, "--edge": None if edge == "limit" else edge}
    words = [str(word) for option, value in options.items() if value is not None for word in (option, value)]
    return join(["asterism", "verify", str(design), *words])


def _edge_mm(text: str) -> float:
    """The edge in mm that the option names; 0 for the limit of an infinitely fine mesh.

    Raises
    ------
    Mistake
        The text is neither a length nor `limit`.
    """
    if text == "limit":
        return 0.0
    try:
        edge = float(text)
    except ValueError:
        edge = -1.0
    if not 0.2 <= edge <= 100.0:
        raise Mistake(f"--edge: {text!r} must be a length from 0.2 to 100 mm, or limit")
    return edge
