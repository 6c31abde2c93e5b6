"""How finely an endless sheet must be cut: one star's cell at edges from 3.5 to 0.24 mm.

python -m benchmarks.creases

The fabric creases along the arms within sqrt(D/N), its bending stiffness over its tension: 0.35 mm for the plate. The
cell is the cheapest model that has these creases, and shows what finer meshes than a whole sheet can have would do.
Beside the two kinds of bending: the paper's hinges at a third of their stiffness, that of the plate. They share nothing
with its element, so what both do is not the element's fault.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.natural_curvature import trace_tubes
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from benchmarks.report import markdown, write_report

SPACING = 17.3205
# the tip of a 10 mm arm is close to a grid point in all of these
CUTS = (5, 7, 12, 19, 26, 45, 71)
THIRD = "paper's hinges, a third as stiff"
KINDS = ("paper", "consistent", THIRD)
ANGLES = {"0": 0.0, "30": np.pi / 6}
HEADER = ["edge mm", "vertices", "contraction", "bump mm", "energy N mm", "radius 0 deg, mm", "radius 30 deg, mm"]


def run(kind: str, k: int) -> dict[str, Any]:
    """The tube design's cell: flat, and rolled with no moment in two directions."""
    bending = "paper" if kind == THIRD else kind
    data = gallery.load("tube").to_dict()
    data["fabric"] = data["fabric"] | {"bending": bending}
    cell = UnitCell(Design.from_dict(data), SPACING / k)
    if kind == THIRD:
        cell.model.parts["hinges"].params[:, 0] /= 3.0
    try:
        flat, _ = relax_flat_cell(cell)
        found = {"kind": kind, "edge_mm": SPACING / k, "vertices": cell.mesh.n_base}
        found |= {"contraction": flat.stretch, "bump_mm": float(flat.bump[0]), "energy_n_mm": flat.energy * cell.area}
        for name, angle in ANGLES.items():
            natural = trace_tubes(cell, flat, angle).natural
            found[f"radius_{name}_mm"] = None if natural is None else natural.radius
        return found
    finally:
        cell.close()


def row(r: dict[str, Any]) -> list[str]:
    """One line of a table."""
    radii = ("-" if r[f"radius_{name}_mm"] is None else f"{r[f'radius_{name}_mm']:.2f}" for name in ANGLES)
    sizes = (f"{r['contraction']:.4f}", f"{r['bump_mm']:.3f}", f"{r['energy_n_mm']:.3f}")
    return [f"{r['edge_mm']:.2f}", str(r["vertices"]), *sizes, *radii]


def main() -> None:
    rows: list[dict[str, Any]] = []
    tables = []
    for kind in KINDS:
        for k in CUTS:
            rows.append(run(kind, k))
            print(kind, "  ".join(row(rows[-1])), flush=True)
        mine = [row(r) for r in rows if r["kind"] == kind]
        tables.append(f"### {kind}\n\n{markdown(HEADER, mine)}")
    write_report("creases", rows, "\n\n".join(tables))


if __name__ == "__main__":
    main()
