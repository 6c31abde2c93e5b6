"""Previews by the universal law against previews by the law of the design's own stars, for materials drawn at random.

    python -m benchmarks.universal_materials

Both laws have the same mesh edge. Distances are between star centres after rigid alignment, rms, in % of the width.
The time is that of choosing the universal law for a new material, in processor seconds, once its file is read.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from asterism.homogenize.campaign.campaign import run_campaign
from asterism.homogenize.campaign.fit_law import fit_law
from asterism.homogenize.universal.material_law import law_edge
from asterism.laws.design_law import material_for_design
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.rigid_fit import rms_distance
from asterism.previews.run import preview
from asterism.previews.universal_choice import packaged_universal_law, sizes_of_stars, universal_choice
from benchmarks.report import markdown, write_report

MATERIALS, SEED = 10, 5
COMPARED = ("lam_n", "kappa", "bending")


def main() -> None:
    rng = np.random.default_rng(SEED)
    rows = [_compared(drawn_sheet(rng)) for _ in range(MATERIALS)]
    header = [
        "stretch, fabric mm, E1/E2, spacing mm",
        *(f"{name} %" for name in COMPARED),
        "distance %",
        "choice s",
        "statement",
    ]
    lines = [[row["material"], *_numbers(row), f"{row['choice_s']:.2f}", row["statement"]] for row in rows]
    text = markdown(header, lines)
    write_report("universal_materials", rows, text)
    print(text)


def _numbers(row: dict[str, Any]) -> list[str]:
    """The differences of the laws and of the shapes; dashes where the universal law does not serve."""
    return [f"{row[name]:.2f}" if name in row else "-" for name in (*COMPARED, "distance_percent")]


def drawn_sheet(rng: np.random.Generator) -> Design:
    """19 equal stars on a random fabric."""
    stretch, thickness, ratio, spacing = (
        rng.uniform(*ends) for ends in ((1.2, 1.8), (0.7, 1.2), (1500, 6000), (14, 20))
    )
    arm, star, width = rng.uniform(0.25, 0.6), rng.uniform(0.3, 0.5), rng.uniform(0.9, 1.5)
    return Design.from_dict(
        {
            "fabric": {"stretch": round(stretch, 3), "thickness_mm": round(thickness, 3)},
            "plastic": {"modulus_ratio": round(ratio)},
            "lattice": {"spacing_mm": round(spacing, 2)},
            "stars": {
                "length_mm": round(arm * spacing, 2),
                "thickness_mm": round(star, 3),
                "width_mm": round(width, 2),
            },
            "border": {"rings": 2},
        }
    )


def _compared(design: Design) -> dict[str, Any]:
    sizes = sizes_of_stars(design)
    packaged_universal_law()
    begin = time.process_time()
    choice = universal_choice(design, sizes)
    seconds = time.process_time() - begin
    fabric, ratio = design.fabric, design.plastic.modulus_ratio
    name = f"{fabric.stretch}, {fabric.thickness_mm:g}, {ratio:g}, {design.lattice.spacing_mm:g}"
    statement = "serves" if choice.law is not None else choice.statement
    row: dict[str, Any] = {"material": name, "choice_s": seconds, "statement": statement}
    if choice.law is None:
        return row
    material = material_for_design(design, law_edge(design))
    with tempfile.TemporaryDirectory() as folder:
        own = fit_law(material, run_campaign(material, Path(folder)))
    ours, theirs = (law.evaluate(design, *sizes[:1].T).value for law in (choice.law, own))
    row |= {name: 100.0 * float(ours[name][0] / theirs[name][0] - 1.0) for name in COMPARED}
    shapes = [preview(design, law) for law in (own, choice.law)]
    centres = [shape.positions[shape.star_vertices] for shape in shapes]
    return row | {"distance_percent": 100.0 * rms_distance(*centres) / float(np.ptp(centres[0], axis=0).max())}


if __name__ == "__main__":
    main()
