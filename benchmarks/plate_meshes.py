"""Exact shapes of fabrics that bend like a plate on graded meshes of two kinds and two edge lengths.

python -m benchmarks.plate_meshes FOLDER

Caps of seven stars, whose hexagonal outline can have both kinds of graded mesh: aligned, as the law's cells and
hexagonal sheets have, and Delaunay, as sheets of all other outlines have. Each exact shape starts from the preview by
the law of the design's own stars, on aligned cells of the same edge length. FOLDER keeps the laws.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from asterism.exact.simulation import exact_shape
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.laws.calibrate import calibrate
from asterism.laws.design_law import material_for_design
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from benchmarks.plate_previews import EDGE_MM, plate
from benchmarks.report import markdown, write_report

DESIGNS = ("cap", "flat cap")
# fifteen edges between stars: arms of four or five edges of `EDGE_MM` have other numbers of these
SHORT_MM = 1.1547
MESHES = (("aligned", EDGE_MM), ("delaunay", EDGE_MM), ("aligned", SHORT_MM))
HEADER = [
    "design",
    "mesh",
    "vertices",
    "creases resolved",
    "estimated mesh error %",
    "energy N mm",
    "height mm",
    "from the first mesh, rms %",
    "preview, rms %",
]


def meshed(name: str, kind: str, edge_mm: float) -> Design:
    """A design of `plate_previews` on another graded mesh."""
    data = plate(name).to_dict()
    return Design.from_dict(data | {"mesh": data["mesh"] | {"kind": kind, "edge_mm": edge_mm}})


def law_at_edge(design: Design, folder: Path) -> Law:
    """The law of the design's stars, on aligned graded cells of its edge length."""
    stars = design.required_stars
    file = folder / f"graded-{stars.length_mm}-{stars.thickness_mm}-{design.mesh.edge_mm}.npz"
    return load_law(file) if file.exists() else calibrate(material_for_design(design), file)


def row(name: str, kind: str, edge_mm: float, folder: Path, first: Shape | None) -> tuple[dict[str, Any], Shape]:
    """The numbers of one exact shape, and the shape; `first` is that on the first mesh."""
    design = meshed(name, kind, edge_mm)
    plan = layout(design)
    same = symmetries(design, plan)
    guess = preview(design, law_at_edge(design, folder), plan=plan)
    exact = exact_shape(design, near=guess, plan=plan)
    summary = exact.summary
    return {
        "name": name,
        "kind": kind,
        "edge_mm": edge_mm,
        "vertices": summary["vertices"],
        "minimum": summary["is_minimum"],
        "creases_resolved": summary["creases_resolved"],
        "mesh_error_percent": summary["mesh_error_percent"],
        "energy_n_mm": summary["energy_n_mm"],
        "height_mm": summary["height_mm"],
        "from_first_percent": None if first is None else compare_shapes(first, exact, plan, same).rms_percent,
        "preview_percent": compare_shapes(exact, guess, plan, same).rms_percent,
    }, exact


def table(rows: list[dict[str, Any]]) -> str:
    body = [
        [
            r["name"],
            f"{r['kind']}, {r['edge_mm']:.2f} mm",
            str(r["vertices"]),
            "yes" if r["creases_resolved"] else "no",
            "-" if r["mesh_error_percent"] is None else f"{r['mesh_error_percent']:.1f}",
            f"{r['energy_n_mm']:.2f}",
            f"{r['height_mm']:.1f}",
            "-" if r["from_first_percent"] is None else f"{r['from_first_percent']:.2f}",
            f"{r['preview_percent']:.2f}",
        ]
        for r in rows
    ]
    return markdown(HEADER, body)


def main() -> None:
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for name in DESIGNS:
        first = None
        for kind, edge_mm in MESHES:
            one, exact = row(name, kind, edge_mm, folder, first)
            first = first or exact
            rows.append(one)
            print(table(rows[-1:]).splitlines()[-1], flush=True)
            write_report("plate_meshes", rows, table(rows))


if __name__ == "__main__":
    main()
