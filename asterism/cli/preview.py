"""`asterism preview`: the homogenised shape of a design."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from shlex import join
from typing import Annotated, Any, Literal

import typer

from asterism.cli.options import DesignFile, LawFile, MaterialFile, output_option


def preview(
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    law: LawFile = None,
    side: Annotated[
        Literal["auto", "up", "down"], typer.Option(help="Side to which the edges go; auto: what the stars want.")
    ] = "auto",
    material: MaterialFile = None,
) -> None:
    """The fast preview: the shape of a design as a smooth sheet, with the stars' bumps laid on it.

    Writes summary.json, shape.vtu, rods.vtu and shape.png. Exit status 1 if what was found is not an equilibrium.
    """
    from asterism.cli.progress import Progress
    from asterism.laws.material import read_design
    from asterism.laws.own_law import law_for
    from asterism.previews.run import preview as run
    from asterism.process.compiling import told_of_compiling
    from asterism.results.files import LAST, check_kept, check_writable
    from asterism.results.write_results import write_results

    plan = read_design(design, material)
    directory = output or design.with_suffix("")
    check_kept(design, directory, LAST)
    check_writable(directory)
    sheet = law_for(plan, law, design, material)
    progress = Progress()
    try:
        with told_of_compiling(progress.say):
            shape = run(plan, sheet, side, progress.say)
    finally:
        progress.close()
    files = write_results(shape, directory)
    typer.echo("\n".join(table_lines(shape.summary)))
    typer.echo(f"{directory}: {', '.join(files)}")
    for line in shape.summary["warnings"]:
        print(f"asterism: {line}", file=sys.stderr)
    if shape.summary["warnings"] and side != "auto":
        print(
            "asterism: asterism verify looks at the form of --side auto; of this one the exact model tells in Python: "
            "asterism.simulate(design, near=shape)",
            file=sys.stderr,
        )
    elif shape.summary["warnings"]:
        same = {"--law": law, "--material": material}
        words = [str(design), *(word for option, file in same.items() if file for word in (option, str(file)))]
        print(f"asterism: the exact model tells:  asterism verify {join(words)}", file=sys.stderr)
    if not shape.summary["is_minimum"]:
        raise typer.Exit(1)


def table_lines(s: Mapping[str, Any]) -> list[str]:
    """The numbers of a summary, one a line."""
    from asterism.previews.uncertainty.expected_height import in_words
    from asterism.shape.tube import degrees, rolled

    outside, tight = len(s["stars_outside_law"]), len(s["stars_tight"])
    expected, height = s["expected_rms_percent"], s["expected_height_percent"]
    others = [degrees(axis) for axis in s["equivalent_axes_deg"] if 1.0 < abs(axis - s["roll_axis_deg"]) < 179.0]
    rows = {
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
    return [f"  {name:<20} {value}" for name, value in rows.items()]
