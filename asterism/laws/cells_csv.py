"""All cells of a law as a table for a spreadsheet: what was solved, on which branch, and whether it is stable."""

from __future__ import annotations

import csv
import io
from typing import Any

from homogenize.law.law import Law
from homogenize.law.law_table import MAX_SEPARATED_CURL

CSV_HEADER = (
    "stretch", "length_mm", "thickness_mm", "width_mm", "held_out", "mesh_edges_per_arm", "answer", "lambda",
    "natural_curvature_per_mm", "tight", "flat_bump_mm", "flat_other_side", "natural_bump_mm", "flat_eigenvalue",
    "flat_supercell_eigenvalue", "natural_eigenvalue", "natural_supercell_eigenvalue", "anisotropy",
)  # fmt: skip


def cells_csv(law: Law) -> str:
    """CSV with one line for each cell; eigenvalues in N/mm, the lowest of the directions."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(CSV_HEADER)
    for cell in law.samples:
        sizes = [cell[name] for name in ("stretch", "length_mm", "thickness_mm", "width_mm", "held_out")]
        found = cell["sample"]
        writer.writerow([*sizes, *(_responses(found) if found else ["", cell["problem"]])])
    return text.getvalue()


def _responses(found: dict[str, Any]) -> list[Any]:
    curvature = sum(found["natural_curvature"]) / len(found["natural_curvature"])
    other = found["down_energy"]
    return [
        " and ".join(str(n) for n in found["segments"]),
        "yes",
        f"{found['lam']:.6f}",
        f"{curvature:.6f}",
        "yes" if abs(curvature) * found["spacing_mm"] > MAX_SEPARATED_CURL else "no",
        f"{found['bump_mm']:.4f}",
        "none" if other is None else f"{other:+.4g} N/mm",
        f"{min(found['natural_bump_mm']):.4f}",
        *(f"{found[name]:.4g}" for name in ("eigenvalue", "supercell_eigenvalue")),
        *(f"{min(found[name]):.4g}" for name in ("natural_eigenvalue", "natural_supercell_eigenvalue")),
        f"{found['anisotropy']:.2g}",
    ]
