"""`asterism verify`: the preview compared with the exact model."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from asterism.cli.common.options import Backend, Contact, DesignFile, LawFile, MaterialFile, output_option
from asterism.cli.common.run import DONE, NO_ANSWER, Run, command


@command
def verify(
    run: Run,
    design: DesignFile,
    output: Annotated[Path | None, output_option("Directory of the report (DESIGN-verified).")] = None,
    law: LawFile = None,
    edge: Annotated[
        float | None, typer.Option(help="Edge length of the exact model's mesh in mm, in place of the design's value.")
    ] = None,
    contact: Contact = None,
    material: MaterialFile = None,
    backend: Backend = "auto",
) -> int:
    """Compare the preview of a design with its exact shape.

    Writes report.html, summary.json, exact.vtu and preview.vtu. The exit status is 1 if the exact model finds no
    minimum.
    """
    from asterism.cli.common.overrides import with_overrides
    from asterism.cli.common.results_folder import results_folder
    from asterism.laws.design_law import law_for_design
    from asterism.laws.replace_material import read_design
    from asterism.reports.verification_files import write_verification
    from asterism.verification.run import verify as compute
    from equilibrium.linear.backends import check_backend

    chosen = with_overrides(
        read_design(design, material),
        {"--edge": ("mesh.edge_mm", edge), "--contact": ("solver.contact", contact)},
    )
    check_backend(backend)
    # simulate and preview write to the design's name, and a summary belongs to the files beside it
    directory = results_folder(design, output, design.with_name(f"{design.stem}-verified"))
    chosen_law = law_for_design(chosen, law, design, material)  # before anything takes time
    with run.computing():
        line = shlex.join(["asterism", *sys.argv[1:]])
        verification = compute(chosen, chosen_law, backend, run.report, run.say, command=line)
        run.say("writing the report")
    files = write_verification(verification, directory)
    run.table(table_rows(verification.summary))
    run.files(directory, files)
    run.warn(*verification.summary["warnings"])
    return DONE if verification.summary["exact"]["is_minimum"] else NO_ANSWER


def table_rows(s: Mapping[str, Any]) -> dict[str, str]:
    """The numbers of a summary by name, as the command prints them."""
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
    return {
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


def _expected(percent: float | None) -> str:
    return "not known" if percent is None else f"{percent:.1f} %"


def _height(percent: float | None, height_mm: float) -> str:
    from asterism.previews.uncertainty.height_error import in_words

    return "not known" if percent is None else in_words(percent, height_mm)


def _mm(pair: list[float]) -> str:
    return f"{pair[1]:.1f} mm, exact {pair[0]:.1f} mm"
