"""A sheet with the bending stiffness of three plates against the same sheet with the paper's hinges.

python -m benchmarks.three_plates

On equilateral triangles the hinges are a plate with three times the stiffness D of the fabric's thickness and modulus,
and Poisson's ratio -1/3. A measured stiffness of 3 D keeps the ratio of the fabric, so the two energies are equal for
cylinders only.
The table gives the distance of the shapes in % of the diameter, and that of one plate for comparison.
"""

from __future__ import annotations

from typing import Any

from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric
from asterism.pattern.layout.build import layout
from asterism.pattern.layout.symmetries import symmetries
from asterism.shape.comparison import compare_shapes
from asterism.shape.shape import Shape
from benchmarks.report import markdown, write_report

EDGES = (2.0, 1.0, 0.7)
SUPPORTED = {"pins": [{"where": "border", "scale": 0.78}]}
SHEETS: dict[str, dict[str, Any]] = {
    "7 stars, free": {"border": {"rings": 1}},
    "7 stars, border supported": {"border": {"rings": 1}, **SUPPORTED},
    "10 stars, free strip": {"border": {"rectangle_mm": [95.0, 36.0]}},
}
FABRIC = Fabric()
PLATE_N_MM = FABRIC.modulus_mpa * FABRIC.thickness_mm**3 / (12.0 * (1.0 - FABRIC.poisson**2))
HINGES = "hinges"
KINDS: dict[str, dict[str, Any]] = {
    HINGES: {},
    "three plates": {"bending": "consistent", "bending_stiffness_n_mm": 3.0 * PLATE_N_MM},
    "one plate": {"bending": "consistent"},
}


def sheet(name: str, kind: str, edge: float) -> Design:
    """A sheet with one of the bending energies, on an even mesh."""
    return Design.from_dict(
        {
            "stars": {"length_mm": 8.0, "thickness_mm": 0.35},
            "fabric": {"modulus_mpa": FABRIC.modulus_mpa, **KINDS[kind]},
            "mesh": {"edge_mm": edge},
            **SHEETS[name],
        }
    )


def compared(name: str, edge: float) -> dict[str, Any]:
    """Distances to the sheet with hinges on the same mesh, and whether all shapes are minima."""
    shapes: dict[str, Shape] = {kind: exact_shape(sheet(name, kind, edge)) for kind in KINDS}
    design = sheet(name, HINGES, edge)
    plan = layout(design)
    row: dict[str, Any] = {"sheet": name, "stars": len(plan.centres), "edge_mm": edge}
    row["minima"] = all(shape.summary["is_minimum"] for shape in shapes.values())
    for kind, shape in shapes.items():
        row[kind] = compare_shapes(shapes[HINGES], shape, plan, symmetries(design, plan)).rms_percent
    return row


def table(rows: list[dict[str, Any]]) -> str:
    others = [kind for kind in KINDS if kind != HINGES]
    header = ["sheet", "edge mm", *(f"{kind}, rms %" for kind in others), "minima"]
    return markdown(
        header,
        [
            [r["sheet"], f"{r['edge_mm']:g}", *(f"{r[k]:.2f}" for k in others), "all" if r["minima"] else "not all"]
            for r in rows
        ],
    )


def main() -> None:
    rows = []
    for name in SHEETS:
        for edge in EDGES:
            rows.append(compared(name, edge))
            print(table(rows[-1:]).splitlines()[-1], flush=True)
            write_report("three_plates", rows, table(rows))


if __name__ == "__main__":
    main()
