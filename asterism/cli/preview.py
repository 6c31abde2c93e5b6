"""`asterism preview`: the homogenised shape of a design."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from shlex import join
from typing import Annotated, Any, Literal

import typer

from asterism.cli.common.options import DesignFile, LawFile, MaterialFile, output_option
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command


@command
def preview(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    law: LawFile = None,
    side: Annotated[
        Literal["auto", "up", "down"],
        typer.Option(help="Side to which the edges bend; auto: the side given by the stars."),
    ] = "auto",
    material: MaterialFile = None,
) -> int:
    """Compute the fast preview of a design: a smooth sheet with the corrugation of the stars.

    Writes summary.json, shape.vtu, rods.vtu and shape.png. The exit status is 1 if no minimum was found.
    """
    from asterism.cli.common.results_folder import results_folder
    from asterism.laws.material import read_design
    from asterism.laws.own_law import law_for
    from asterism.previews.run import preview as compute
    from asterism.results.write_results import write_results

    chosen = read_design(design, material)
    directory = results_folder(design, output, design.with_suffix(""))
    chosen_law = law_for(chosen, law, design, material)
    with run.computing():
        shape = compute(chosen, chosen_law, side, run.say)
    files = write_results(shape, directory)
    run.table(table_rows(shape.summary))
    run.files(directory, files)
    warnings = shape.summary["warnings"]
    run.warn(*warnings)
    if warnings and side != "auto":
        run.warn(
            "asterism verify checks the form of --side auto; check this one in Python: "
            "asterism.simulate(design, near=shape)"
        )
    elif warnings:
        options = {"--law": law, "--material": material}
        words = [str(design), *(word for option, file in options.items() if file for word in (option, str(file)))]
        run.warn(f"check with the exact model:  asterism verify {join(words)}")
    return DONE if shape.summary["is_minimum"] else NO_ANSWER


def table_rows(s: Mapping[str, Any]) -> dict[str, str]:
    """The numbers of a summary by name, as the command prints them."""
    from asterism.previews.uncertainty.height_error import in_words
    from asterism.shape.tube import degrees, rolled

    outside, tight = len(s["stars_outside_law"]), len(s["stars_tight"])
    expected, height = s["expected_rms_percent"], s["expected_height_percent"]
    others = [degrees(axis) for axis in s["equivalent_axes_deg"] if 1.0 < abs(axis - s["roll_axis_deg"]) < 179.0]
    return {
        "stars": f"{s['stars']}, {outside} outside the law, {tight} curled tightly",
        "height": f"{s['height_mm']:.2f} mm"
        + ("" if height is None else f", give or take {in_words(height, s['height_mm'])}"),
        "extent": " x ".join(f"{size:.1f}" for size in s["extent_mm"]) + " mm",
        "contraction": "-" if s["contraction"] is None else f"{s['contraction']:.4f}",
        "rolled about": rolled(s) + (f"; or {', '.join(others)} deg" if others else ""),
        "energy": f"{s['energy_n_mm']:.4f} N mm",
        "softest modes": ", ".join(f"{value:.1e}" for value in s["soft_modes_n_mm3"]) + " N/mm3",
        "equilibrium": "stable" if s["is_minimum"] else "no",
        "expected distance": "not known" if expected is None else f"{expected:.1f} % of the diameter",
        "law": f"{s['law']['material']}, stretch {s['law']['stretch']:g}, edges of {s['law']['edge_mm']:g} mm",
        "shell": f"{s['shell_triangles']} triangles, {s['dofs']} unknowns",
        "work": f"{s['iterations']} iterations, {s['wall_s']:.2f} s",
    }
