"""`asterism verify`: the preview held against the exact model."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from asterism.cli.options import Backend, Contact, DesignFile, LawFile, MaterialFile, output_option


def verify(
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the report (DESIGN-verified).")] = None,
    law: LawFile = None,
    edge: Annotated[
        float | None, typer.Option(help="Edge length of the exact model's mesh in mm, in place of the design's.")
    ] = None,
    contact: Contact = None,
    material: MaterialFile = None,
    backend: Backend = "auto",
) -> None:
    """Preview and exact model of a design, compared.

    Writes report.html, summary.json, exact.vtu and preview.vtu. Exit status 1 if the exact model finds no minimum.
    """
    from asterism.cli.overrides import changed
    from asterism.cli.progress import Progress
    from asterism.laws.material import read_design
    from asterism.laws.own_law import law_for
    from asterism.process.compiling import told_of_compiling
    from asterism.reports.verification_files import write_verification
    from asterism.results.files import LAST, check_kept, check_writable
    from asterism.verification.run import verify as run
    from equilibrium.linear.factor import check_backend

    plan = changed(
        read_design(design, material),
        {"--edge": ("mesh.edge_mm", edge), "--contact": ("solver.contact", contact)},
    )
    check_backend(backend)
    # simulate and preview write to the design's name, and a summary belongs to the files beside it
    directory = output or design.with_name(f"{design.stem}-verified")
    check_kept(design, directory, LAST)
    check_writable(directory)
    sheet = law_for(plan, law, design, material)  # before anything takes time
    progress = Progress()
    try:
        with told_of_compiling(progress.say):
            asked = shlex.join(["asterism", *sys.argv[1:]])
            found = run(plan, sheet, backend, progress.report, progress.say, command=asked)
    finally:
        progress.close()
    progress.say("writing the report")
    files = write_verification(found, directory)
    typer.echo("\n".join(table_lines(found.summary)))
    typer.echo(f"{directory}: {', '.join(files)}")
    for line in found.summary["warnings"]:
        print(f"asterism: {line}", file=sys.stderr)
    if not found.summary["exact"]["is_minimum"]:
        raise typer.Exit(1)


def table_lines(s: Mapping[str, Any]) -> list[str]:
    """The numbers of a summary, one a line."""
    from asterism.shape.mesh_error import in_words
    from asterism.verification.numbers import times

    radius, rms, height = (
        s[name] for name in ("roll_radius_error_percent", "expected_rms_percent", "expected_height_percent")
    )
    release, near = s["starts"]["release"], s["starts"]["preview"]
    apart = f"two minima, {s['starts_distance_percent']:.2g} % apart"
    if not (release["is_minimum"] and near["is_minimum"]):
        apart = "one start in a minimum"
    agree = "both starts in one minimum" if s["starts_agree"] else apart
    if not s["exact"]["is_minimum"]:
        agree = "no minimum"
    rows = {
        "same form": {True: "yes", False: "no", None: "not known: no certified exact shape"}[s["same_branch"]],
        "distance": f"{s['rms_percent']:.2f} % of the diameter rms, {s['max_percent']:.1f} % at most",
        "expected": f"{_expected(rms)}, height {_height(height, s['heights_mm'][1])}",
        "star centres": f"{s['rms_stars_percent']:.2f} % rms, {s['max_stars_percent']:.1f} % at most",
        "height": _mm(s["heights_mm"]),
        "rise over the pins": "-" if s["rises_mm"] is None else _mm(s["rises_mm"]),
        "radius of the roll": "-" if radius is None else _mm(s["roll_radii_mm"]),
        "exact mesh error": in_words(s["exact"]),
        "exact model": f"{agree}; {release['iterations']} iterations, {near['iterations']} from the preview",
        "seconds": f"preview {s['preview_s']:.2f}, again {s['preview_again_s']:.3f}; exact {s['exact_s']:.1f}",
        "speed-up": times(s["speedup"]),
    }
    return [f"  {name:<20} {value}" for name, value in rows.items()]


def _expected(percent: float | None) -> str:
    return "not known" if percent is None else f"{percent:.1f} %"


def _height(percent: float | None, height_mm: float) -> str:
    from asterism.previews.uncertainty.expected_height import in_words

    return "not known" if percent is None else in_words(percent, height_mm)


def _mm(pair: list[float]) -> str:
    return f"{pair[1]:.1f} mm, exact {pair[0]:.1f} mm"
