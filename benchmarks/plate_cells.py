"""Unit cells of the plate on graded meshes: how answers depend on the mesh, and what a law of the plate would cost.

python -m benchmarks.plate_cells

Natural curvatures at 0 and 30 degrees, and the sixfold term times the mean curvature over the bending stiffness, which
previews limit to 0.7. An arm on its own has the curvature of its rest shape, per mm of the print.
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.law.material import load_material
from asterism.pattern.design.design import Design
from asterism.pattern.design.materials import Fabric, Plastic, rest_curvature
from benchmarks.report import markdown, write_report

SPACING = 10.0 * np.sqrt(3.0)
SIZES = ((5.7735, 0.3), (5.7735, 0.43), (9.2376, 0.34), (9.2376, 0.43))  # length and thickness, mm
# bending, graded, edges between stars
MESHES = (("paper", False, 15), ("consistent", False, 15), ("consistent", True, 15), ("consistent", True, 21))
# edges between stars of the packaged law
LAW_EDGES = 15
HEADER = ["star", "mesh", "lambda", "kappa of an arm", "kappa 0 deg", "30 deg", "c3 kappa / D", "s of the processor"]


def cell(length: float, thickness: float, bending: str, graded: bool, k: int) -> dict[str, Any]:
    """The sample of one cell, with its cost."""
    design = Design.from_dict(
        {
            "stars": {"length_mm": length, "thickness_mm": thickness},
            "border": {"rings": 1},
            "fabric": {"bending": bending},
            "mesh": {"graded": graded},
        }
    )
    start = time.process_time()
    sample = solve_cell(design, SPACING / k)
    seconds = time.process_time() - start
    row = {"length_mm": length, "thickness_mm": thickness, "bending": bending, "graded": graded, "edges": k}
    row |= {"arm": float(rest_curvature(thickness, Fabric(), Plastic())), "seconds": seconds, "failed": sample.failed}
    if sample.natural_curvature is None or sample.bending is None or sample.sixfold is None:
        return row
    kappa, bend = sample.natural_curvature, float(np.mean(sample.bending))
    row |= {"lam": sample.lam, "kappa_0": float(kappa[0]), "kappa_30": float(kappa[-1])}
    return row | {"sixfold_share": float(sample.sixfold * np.mean(kappa) / bend)}


def minutes(rows: list[dict[str, Any]]) -> float:
    """Minutes of the processor for all cells of the packaged law's plan, at the mean of the plate's graded cells."""
    of_law = [r["seconds"] for r in rows if r["graded"] and r["edges"] == LAW_EDGES]
    return len(load_material().tasks()) * float(np.mean(of_law)) / 60.0


def table(rows: list[dict[str, Any]]) -> str:
    body = []
    for r in rows:
        mesh = f"{'hinges' if r['bending'] == 'paper' else 'plate'}, {SPACING / r['edges']:.2f} mm"
        mesh += ", graded" if r["graded"] else ""
        numbers = [f"{r['arm']:.4f}"]
        if "lam" in r:
            numbers = [f"{r['lam']:.4f}", *numbers, f"{r['kappa_0']:.4f}", f"{r['kappa_30']:.4f}"]
            numbers.append(f"{r['sixfold_share']:.2f}")
        else:
            numbers = ["-", *numbers, "-", "-", "-"]
        body.append([f"l {r['length_mm']:g}, h {r['thickness_mm']:g}", mesh, *numbers, f"{r['seconds']:.1f}"])
    return markdown(HEADER, body)


def main() -> None:
    solve_cell(Design.from_dict({"stars": {"length_mm": 5.0}, "border": {"rings": 1}}), 2.9)  # compiles
    cell(5.7735, 0.4, "consistent", True, 6)
    rows = []
    for length, thickness in SIZES:
        for mesh in MESHES:
            rows.append(cell(length, thickness, *mesh))
            print(table(rows[-1:]).splitlines()[-1], flush=True)
    cells = len(load_material().tasks())
    text = f"{table(rows)}\n\nThe {cells} cells of the packaged law's plan would take {minutes(rows):.0f} minutes "
    text += (
        "of the processor with graded meshes of the plate: those whose arms are a whole number of edges long; others\n"
    )
    text += "cost twice as much.\n"
    write_report("plate_cells", rows, text)


if __name__ == "__main__":
    main()
