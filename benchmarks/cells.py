"""Unit cells: what a sample costs, and how its answers depend on the mesh.

python -m benchmarks.cells
"""

from __future__ import annotations

import statistics
import time
from typing import Any

import numpy as np

from asterism.homogenize.cell.arm_segments import arm_segments
from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.sample import solve_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from benchmarks.report import markdown, write_report

SPACING = 10.0 * np.sqrt(3.0)
SIZES = ((10.0, 0.4), (10.0, 0.6), (7.0, 0.3))  # length and thickness, mm
EDGES = (2.1, 1.15)
FINER = tuple(SPACING / k for k in (9, 12, 15, 20, 30))
BETWEEN = ((SPACING / 9, 3.5), (SPACING / 9, 4.5), (SPACING / 15, 5.5), (SPACING / 15, 7.5))  # arm in mesh edges
RUNS = 3


def main() -> None:
    solve_cell(sheet(5.0, 0.4), 2.1)  # compiles
    costs = [cost(length, thickness, edge) for length, thickness in SIZES for edge in EDGES]
    text = f"Seconds of the processor for one sample by part, one thread, median of {RUNS}:\n\n{cost_table(costs)}\n\n"
    meshes = [answers(length, thickness, edge) for length, thickness in SIZES for edge in FINER]
    text += f"Answers by the cell's mesh:\n\n{mesh_table(meshes)}\n\n"
    cuts = [either(edge, edges * edge, 0.4) for edge, edges in BETWEEN]
    text += "Arms (h 0.4 mm) half an edge from a whole number, cut into one edge less and one more; and the mean of\n"
    text += f"the neighbouring whole numbers:\n\n{cut_table(cuts)}"
    write_report("cells", costs + meshes + cuts, text)
    print(text)


def sheet(length: float, thickness: float) -> Design:
    """Equal stars of the paper's material."""
    return Design.from_dict({"stars": {"length_mm": length, "thickness_mm": thickness}, "border": {"rings": 1}})


def cost(length: float, thickness: float, edge: float) -> dict[str, Any]:
    """Median seconds of the processor for a sample; parts by their share of the wall's, which others may lengthen."""
    runs = []
    for _ in range(RUNS):
        start, wall = time.process_time(), time.perf_counter()
        sample = solve_cell(sheet(length, thickness), edge)
        spent, wall = time.process_time() - start, time.perf_counter() - wall
        runs.append({part: seconds * spent / wall for part, seconds in sample.seconds.items()} | {"all": spent})
    seconds = {part: statistics.median(run[part] for run in runs) for part in runs[0]}
    return {
        "length_mm": length, "thickness_mm": thickness, "edge_mm": edge, "vertices": sample.vertices,
        "meshes": len(arm_segments(sheet(length, thickness), edge)), "iterations": sample.iterations,
        "seconds": seconds,
    }  # fmt: skip


def answers(length: float, thickness: float, edge: float) -> dict[str, Any]:
    """What a cell says at an edge length."""
    sample = solve_cell(sheet(length, thickness), edge).to_dict()
    stretch = np.sqrt(np.multiply(sample["natural_hoop"], sample["natural_axial"]))
    return {
        "length_mm": length, "thickness_mm": thickness, "edge_mm": edge, "lam": sample["lam"],
        "lam_n": float(np.mean(stretch)), "kappa": float(np.mean(sample["natural_curvature"])),
        "bending": float(np.mean(sample["bending"])),
    }  # fmt: skip


def either(edge: float, length: float, thickness: float) -> dict[str, Any]:
    """Natural curvature around the print's y axis, with either number of edges."""
    low = int(length / edge)

    def natural(arm: float, segments: int) -> float:
        cell = UnitCell(sheet(arm, thickness), edge, (1, 1), segments)
        tube = trace_tubes(cell, relax_flat_cell(cell)[0], 0.0).natural
        cell.close()
        return 0.0 if tube is None else tube.contracted_curvature

    return {
        "length_mm": length, "edge_mm": edge, "less": natural(length, low), "more": natural(length, low + 1),
        "around": 0.5 * (natural(low * edge, low) + natural((low + 1) * edge, low + 1)),
    }  # fmt: skip


def cost_table(rows: list[dict[str, Any]]) -> str:
    parts = list(dict.fromkeys(part for row in rows for part in row["seconds"]))
    table = [
        [_star(r), f"{r['edge_mm']:g}", f"{r['meshes']} x {r['vertices']}", str(r["iterations"])]
        + [f"{r['seconds'].get(part, 0.0):.2f}" for part in parts]
        for r in rows
    ]
    return markdown(["star, mm", "edge mm", "vertices", "iterations", *(f"{part} s" for part in parts)], table)


def mesh_table(rows: list[dict[str, Any]]) -> str:
    names = ("lam", "lam_n", "kappa", "bending")
    table = [[_star(r), f"{r['edge_mm']:.2f}", *(f"{r[name]:.4f}" for name in names)] for r in rows]
    return markdown(["star, mm", "edge mm", "lambda", "lambda_n", "kappa 1/mm", "D N mm"], table)


def cut_table(rows: list[dict[str, Any]]) -> str:
    rows = [r | {"mean": 0.5 * (r["less"] + r["more"])} for r in rows]
    names = ("less", "more", "mean", "around")
    table = [[f"{r['length_mm']:.2f}", f"{r['edge_mm']:.2f}", *(f"{r[k]:.5f}" for k in names)] for r in rows]
    header = ["l mm", "edge mm", "kappa, one edge less", "one more", "their mean", "mean of the neighbours"]
    return markdown(header, table)


def _star(r: dict[str, Any]) -> str:
    return f"h {r['thickness_mm']:g}, l {r['length_mm']:g}"


if __name__ == "__main__":
    main()
