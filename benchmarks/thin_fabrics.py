"""Flat cells of thin fabrics on several meshes: which branch they take, and why laws of coarse cells fail there.

    python -m benchmarks.thin_fabrics

The fabric between stiff stars is under compression. If it is thin, it can buckle between the stars, out of the symmetry
of the star. On a coarse mesh the cell ends on that branch; on a fine mesh it keeps its symmetry, with less energy.
"""

from __future__ import annotations

import numpy as np

from asterism.homogenize.cell.flat_cell import relax_flat_cell
from asterism.homogenize.cell.unit_cell import UnitCell
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from benchmarks.report import markdown, write_report

EDGES_BETWEEN_STARS = (10, 15, 20, 30)
# fabric thickness (mm) and stretch; modulus ratio 4139, arms of 0.4 spacings, 0.4 mm thick and 1.2 mm wide
FABRICS = ((0.5, 1.5), (0.6, 1.5), (0.8, 1.5))


def main() -> None:
    rows, lines = [], []
    for thickness, stretch in FABRICS:
        for edges in EDGES_BETWEEN_STARS:
            row = _flat_cell(thickness, stretch, edges)
            rows.append(row)
            lines.append(
                [
                    f"{thickness:g} mm, {stretch:g}",
                    f"{edges}",
                    f"{row['fabric_to_edge']:.2f}",
                    f"{row['lam']:.4f}",
                    f"{row['smallest_stretch']:.4f} / {row['largest_stretch']:.4f}",
                    f"{row['height_mm']:.2f}",
                    f"{row['energy']:.5f}",
                ]
            )
    header = ["fabric, stretch", "edges between stars", "thickness/edge", "contraction", "principal stretches"]
    text = markdown([*header, "height mm", "energy N/mm"], lines)
    write_report("thin_fabrics", rows, text)
    print(text)


def _flat_cell(thickness: float, stretch: float, edges: int) -> dict[str, float]:
    spacing = float(DEFAULT_SPACING_MM)
    design = Design.from_dict(
        {
            "fabric": {"stretch": stretch, "thickness_mm": thickness},
            "plastic": {"modulus_ratio": 4139.0},
            "stars": {"length_mm": 0.4 * spacing, "thickness_mm": 0.4, "width_mm": 1.2},
            "border": {"rings": 1},
        }
    )
    cell = UnitCell(design, spacing / edges)
    flat = relax_flat_cell(cell)[0]
    principal = np.linalg.eigvalsh(flat.deformation)
    heights = flat.state.positions[: cell.mesh.n_base, 2]
    cell.close()
    return {
        "thickness_mm": thickness,
        "stretch": stretch,
        "edges": edges,
        "fabric_to_edge": thickness * edges / spacing,
        "lam": flat.stretch,
        "smallest_stretch": float(principal[0]),
        "largest_stretch": float(principal[1]),
        "height_mm": float(np.ptp(heights)),
        "energy": flat.energy,
    }


if __name__ == "__main__":
    main()
