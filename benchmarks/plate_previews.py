"""Previews of fabrics that bend like a plate, against exact shapes on graded meshes of the same edge length.

python -m benchmarks.plate_previews FOLDER [NAME ...]

Ten small designs, free and supported, of several outlines; each has the law of its own stars, whose cells have the
design's graded mesh. Beside it, previews by laws whose cells have even meshes of
a fifteenth of the spacing. Aligned meshes of these edges do not resolve the creases: `benchmarks.plate_meshes` measures
how far that moves exact shapes. FOLDER keeps the laws. With names, only these designs are computed, and no table is
written.
"""

from __future__ import annotations

import math
import statistics
import sys
from pathlib import Path
from typing import Any

from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.laws.calibrate import calibrate
from asterism.laws.design_law import material_for_design
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from asterism.verification.run import verify
from benchmarks.report import markdown, write_report

EDGE_MM = 1.9245  # nine edges between stars; arms of three, four and five of them
LENGTHS = {3: 5.7735, 4: 7.698, 5: 9.6225}
FLAT_BORDER = {"pins": [{"where": "border", "scale": 0.78}]}
HIGH_BORDER = {"pins": [{"where": "border", "scale": 0.72}]}
CORNERS = {"pins": [{"where": "corners", "scale": 0.76}]}
# radius 38 mm
CIRCLE = [[38.0 * math.cos(k * math.pi / 12), 38.0 * math.sin(k * math.pi / 12)] for k in range(24)]
# edges of an arm, thickness in mm, outline and supports
DESIGNS: dict[str, tuple[int, float, dict[str, Any]]] = {
    "tube": (5, 0.36, {"border": {"rings": 2}}),
    "tube of short arms": (3, 0.36, {"border": {"rings": 2}}),
    "cap": (5, 0.36, {"border": {"rings": 1}}),
    "flat cap": (4, 0.43, {"border": {"rings": 1}}),
    "strip": (4, 0.36, {"border": {"rectangle_mm": [95.0, 36.0]}}),
    "square": (4, 0.43, {"border": {"rectangle_mm": [75.0, 75.0]}}),
    "disk": (3, 0.43, {"border": {"polygon_mm": CIRCLE}}),
    "dome": (5, 0.36, {"border": {"rings": 2}, **FLAT_BORDER}),
    "high dome": (4, 0.36, {"border": {"rings": 2}, **HIGH_BORDER}),
    "sheet on corners": (4, 0.43, {"border": {"rings": 2}, **CORNERS}),
}
HEADER = [
    "design",
    "rms %",
    "nearer minimum, rms %",
    "energies apart %",
    "law of even cells, rms %",
    "height, preview mm",
    "exact mm",
    "same form",
    "starts agree",
    "estimate, rms %",
]


def plate(name: str) -> Design:
    """One of the designs."""
    segments, thickness, more = DESIGNS[name]
    return Design.from_dict(
        {
            "name": name,
            "stars": {"length_mm": LENGTHS[segments], "thickness_mm": thickness},
            "fabric": {"bending": "consistent"},
            "mesh": {"edge_mm": EDGE_MM, "graded": True},
            **more,
        }
    )


def own_law(design: Design, folder: Path) -> Law:
    """The law of the design's stars; equal stars share it."""
    stars, mesh = design.required_stars, "graded" if design.mesh.graded else "even"
    file = folder / f"{mesh}-{stars.length_mm}-{stars.thickness_mm}.npz"
    return load_law(file) if file.exists() else calibrate(material_for_design(design), file)


def compared(name: str, folder: Path) -> dict[str, Any]:
    """The verification of one design as numbers."""
    design = plate(name)
    done = verify(design, own_law(design, folder))
    summary = done.summary
    energies = [shape.summary["energy_n_mm"] for shape in done.exact.values()]
    high, preview_high = done.comparison.heights_mm
    even = design.model_copy(update={"mesh": design.mesh.model_copy(update={"graded": False})})
    plan, exact = layout(design), done.exact[done.result]
    unlike = compare_shapes(exact, preview(design, own_law(even, folder)), plan, symmetries(design, plan))
    return {
        "name": name,
        "minimum": summary["exact"]["is_minimum"],
        "rms_percent": summary["rms_percent"],
        "nearer_rms_percent": min(each.rms_percent for each in done.comparisons.values()),
        "energies_apart_percent": 100.0 * (max(energies) - min(energies)) / min(energies),
        "even_cells_rms_percent": unlike.rms_percent,
        "preview_height_mm": preview_high,
        "exact_height_mm": high,
        "same_branch": summary["same_branch"],
        "starts_agree": summary["starts_agree"],
        "expected_rms_percent": summary["expected_rms_percent"],
        "exact_s": summary["exact_s"],
    }


def table(rows: list[dict[str, Any]]) -> str:
    body = [
        [
            r["name"],
            f"{r['rms_percent']:.2f}",
            f"{r['nearer_rms_percent']:.2f}",
            f"{r['energies_apart_percent']:.2f}",
            f"{r['even_cells_rms_percent']:.2f}",
            f"{r['preview_height_mm']:.1f}",
            f"{r['exact_height_mm']:.1f}",
        ]
        + ["-" if r[key] is None else "yes" if r[key] else "no" for key in ("same_branch", "starts_agree")]
        + ["-" if r["expected_rms_percent"] is None else f"{r['expected_rms_percent']:.1f}"]
        for r in rows
    ]
    return markdown(HEADER, body)


def main() -> None:
    folder, names = Path(sys.argv[1]), sys.argv[2:] or list(DESIGNS)
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in names:
        rows.append(compared(name, folder))
        print(table(rows[-1:]).splitlines()[-1], flush=True)
        if not sys.argv[2:]:
            far, near = ([r[key] for r in rows] for key in ("rms_percent", "nearer_rms_percent"))
            text = f"{table(rows)}\n\n{len(rows)} of {len(names)} designs: median {statistics.median(far):.2f} %, "
            text += f"largest {max(far):.2f} %; to the nearer of two exact minima {statistics.median(near):.2f} and "
            write_report("plate_previews", rows, text + f"{max(near):.2f} %.")


if __name__ == "__main__":
    main()
