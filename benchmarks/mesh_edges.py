"""Previews on the mesh of the exact model, and their limit for an infinitely fine mesh: tube and dome of the gallery.

python -m benchmarks.mesh_edges FOLDER

Each preview is made by the packaged law on meshes of the exact model's edge length. FOLDER keeps the exact shapes in
folders such as tube-0.7, and only those that are there are compared by their surfaces; `--solve` computes the others,
which takes minutes for 0.48 mm. Radii are those of the cylinder nearest to the star centres. Those of meshes without a
kept shape, and the limit of the exact radii, are from `benchmarks.convergence`.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

from asterism.homogenize.errors import LawError
from asterism.homogenize.law.law import Law
from asterism.homogenize.law.law_file import load_law
from asterism.homogenize.law.mesh_edges import whole_edge
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.previews.mesh_law import law_on_mesh
from asterism.previews.run import preview
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from asterism.verification.mesh_limit import mesh_limit
from benchmarks.accuracy.exact import exact
from benchmarks.convergence import cylinder_radius
from benchmarks.orders import rates
from benchmarks.report import RESULTS, markdown, write_report

EDGES = (2.0, 1.15, 0.7, 0.48)
SAME_EDGE = 0.01
HEADER = [
    "design, edge mm",
    "size, exact mm",
    "preview mm",
    "off %",
    "surface, rms %",
    "limit by preview mm",
    "exact size in the limit mm",
    "mesh error by previews %",
    "by the exact meshes %",
    "limit, s",
]


def design_of(name: str, edge: float) -> Design:
    """A design of the gallery with a mesh of this edge length (mm)."""
    data = gallery.load(name).to_dict()
    return Design.from_dict(data | {"name": f"{name}-{edge:g}", "mesh": data["mesh"] | {"edge_mm": edge}})


def size(name: str, shape: Shape) -> float:
    """mm, the radius of the tube, or the height of the dome."""
    return cylinder_radius(shape) if name == "tube" else shape.height_mm


def known_rows(name: str) -> list[dict[str, Any]]:
    """The rows of `benchmarks.convergence` for even aligned meshes with the paper's hinges."""
    rows = json.loads((RESULTS / "convergence.json").read_text())["rows"]
    mesh = {"kind": "aligned"}
    return [
        row
        for row in rows
        if row["design"] == name
        and row["bending"] == "paper"
        and {key: value for key, value in row["mesh"].items() if key != "edge_mm"} == mesh
    ]


def compared(name: str, edge: float, law: Law, folder: Path, solve: bool) -> dict[str, Any] | None:
    """One row; None if the law has no cells of this edge, or nothing is known about the exact shape."""
    design = design_of(name, edge)
    plan = layout(design)
    try:
        shown = preview(design, law_on_mesh(law, design, plan, edge), plan=plan)
    except LawError as error:
        print(f"{design.name}: {error}", flush=True)
        return None
    begun = time.perf_counter()
    limit = mesh_limit(design, law, shown, plan)
    spent = time.perf_counter() - begun
    ratio = None
    if limit is not None and limit.roll_radius_mm is not None:
        ratio = limit.roll_radius_mm / shown.summary["roll_radius_mm"]
    elif limit is not None:
        ratio = limit.height_mm / shown.height_mm
    row = {
        "name": name,
        "edge_mm": whole_edge(edge, design.lattice.spacing_mm),
        "preview_mm": size(name, shown),
        "limit_mm": None if ratio is None else ratio * size(name, shown),
        "limit_distance_percent": None if limit is None else limit.distance_percent,
        "ratio": ratio,
        "limit_s": spent,
    }
    if solve or (folder / design.name / "summary.json").exists() or (folder / design.name / "released").exists():
        of_exact = exact(design, folder)
        comparison = compare_shapes(of_exact, shown, plan, symmetries(design, plan))
        return row | {
            "exact_mm": size(name, of_exact),
            "rms_percent": comparison.rms_percent,
            "mesh_error_percent": of_exact.summary["mesh_error_percent"],
        }
    key = "radius_mm" if name == "tube" else "height_mm"
    for known in known_rows(name):
        if abs(known["mesh"]["edge_mm"] / row["edge_mm"] - 1.0) < SAME_EDGE:
            mesh_error = known["mesh_error_percent"]
            return row | {"exact_mm": known[key], "rms_percent": None, "mesh_error_percent": mesh_error}
    return None


def table(rows: list[dict[str, Any]]) -> str:
    """The rows as Markdown."""

    def percent(value: float | None) -> str:
        return "-" if value is None else f"{value:.2f}"

    body = [
        [
            f"{r['name']}, {r['edge_mm']:.2f}",
            f"{r['exact_mm']:.2f}",
            f"{r['preview_mm']:.2f}",
            f"{100.0 * (r['preview_mm'] / r['exact_mm'] - 1.0):+.1f}",
            percent(r["rms_percent"]),
            percent(r["limit_mm"]),
            percent(None if r["ratio"] is None else r["ratio"] * r["exact_mm"]),
            percent(r["limit_distance_percent"]),
            percent(r["mesh_error_percent"]),
            f"{r['limit_s']:.2f}",
        ]
        for r in rows
    ]
    return markdown(HEADER, body)


def main() -> None:
    folder, law = Path(sys.argv[1]), load_law()
    rows = []
    for name in ("tube", "dome"):
        for edge in EDGES:
            row = compared(name, edge, law, folder, "--solve" in sys.argv[2:])
            if row is not None:
                rows.append(row)
                print(table([row]).splitlines()[-1], flush=True)
    limit = rates(known_rows("tube"))["radius_mm_limit"]
    text = (
        f"{table(rows)}\n\nSizes are the radius of the tube and the height of the dome. The exact radii have the limit "
        f"{limit:.2f} mm by extrapolation (`python -m benchmarks.convergence`). Exact sizes in the limit are those on "
        "this mesh times the ratio of two previews, in the limit and on this mesh. A row without a surface distance is "
        "compared with the size in the table of `benchmarks.convergence`."
    )
    print(text.splitlines()[-1])
    write_report("mesh_edges", rows, text)


if __name__ == "__main__":
    main()
