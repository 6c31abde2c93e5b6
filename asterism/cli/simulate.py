"""`asterism simulate`: the exact shape of a design."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from asterism.cli.common.options import Backend, Contact, DesignFile, MaterialFile, output_option
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command


@command
def simulate(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the results (the design file's name).")] = None,
    edge: Annotated[
        float | None, typer.Option(help="Edge length of the mesh in mm, in place of the design's value.")
    ] = None,
    start: Annotated[str | None, typer.Option(help="bump or flat, in place of the design's value.")] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of the initial guess's noise, in place of the design's value.")
    ] = None,
    starts: Annotated[
        int,
        typer.Option(
            min=1,
            max=1000,
            help="Number of initial guesses. The result is the lowest minimum whose stars are on their side.",
        ),
    ] = 1,
    fabric_bending: Annotated[
        str | None, typer.Option(help="paper, consistent or none, in place of the design's value.")
    ] = None,
    contact: Contact = None,
    material: MaterialFile = None,
    backend: Backend = "auto",
) -> int:
    """Compute the exact shape of a design, and certify that it is an equilibrium.

    Writes summary.json, shape.vtu, rods.vtu and shape.png. With --starts also minimum-2.vtu, minimum-2.png and so on,
    one pair for each further minimum. The exit status is 1 if no minimum was found.
    """
    from asterism.cli.common.overrides import with_overrides
    from asterism.cli.common.results_folder import results_folder
    from asterism.exact.simulation import simulate as compute
    from asterism.laws.material import read_design
    from asterism.results.write_results import write_results

    changed = with_overrides(
        read_design(design, material),
        {
            "--edge": ("mesh.edge_mm", edge),
            "--start": ("solver.start", start),
            "--seed": ("solver.seed", seed),
            "--fabric-bending": ("fabric.bending", fabric_bending),
            "--contact": ("solver.contact", contact),
        },
    )
    directory = results_folder(design, output, design.with_suffix(""))
    with run.computing():
        shape = compute(changed, backend, run.report, run.say, starts)
    files = write_results(shape, directory)
    run.table(table_rows(shape.summary))
    run.files(directory, files)
    run.warn(*shape.summary["warnings"])
    return DONE if shape.summary["is_minimum"] else NO_ANSWER


def table_rows(s: Mapping[str, Any]) -> dict[str, str]:
    """The numbers of a summary by name, as the command prints them."""
    from asterism.shape.mesh_error import in_words
    from asterism.shape.tube import rolled

    extent = " x ".join(f"{size:.1f}" for size in s["extent_mm"])
    rows = {
        "stars": f"{s['stars_up']} of {s['stars_total']} up",
        "height": f"{s['height_mm']:.2f} mm",
        "extent": f"{extent} mm",
        "contraction": "-" if s["contraction"] is None else f"{s['contraction']:.4f}",
        "rolled about": rolled(s),
        "energy": f"{s['energy_n_mm']:.4f} N mm",
        "gradient": f"{s['gradient_norm']:.1e} N",
        "smallest eigenvalue": f"{s['smallest_eigenvalue']:.3e} N/mm",
        "equilibrium": "stable" if s["is_minimum"] else "no",
        "mesh": f"{s['vertices']} vertices, {s['mesh']}",
        "mesh error": in_words(s),
        "work": f"{s['iterations']} iterations, {s['factorisations']} factorisations, {s['wall_s']:.1f} s",
    }
    if s["starts"] > 1:
        if lost := s["starts_lost"]:
            rows["starts"] = f"{s['starts']}, of which {lost} led to no equilibrium"
        rows |= {f"minimum {number}": _minimum(m) for number, m in enumerate(s["minima"], 1)}
    return rows


def _minimum(m: Mapping[str, Any]) -> str:
    axis = "" if m["roll_axis_deg"] is None else f", rolled about {m['roll_axis_deg']:.0f} deg"
    away = f"{m['distance_percent']:.1f} % away, " if m["distance_percent"] >= 0.05 else ""
    return f"{m['energy_n_mm']:.4f} N mm, {m['stars_up']} up{axis}; {away}{m['starts']} starts"
