"""How a sheet that its supports stretch loses its bumps: exact sheets of seven equal stars on held borders.

python -m benchmarks.stretched_bumps

For each scale of the border, the bumps of the middle star in the exact model: its centre over the mean of its tips, and
that over the bump at the size of the flat cells. The preview divides heights by 1 + e/e_0 at the strain e over the flat
cell, so that the last column is the e_0 of this scale. `bump_strain` of the preview model is their median.
"""

from __future__ import annotations

import numpy as np

from asterism.exact.simulation import exact_shape
from asterism.homogenize.law.law_file import load_law
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from asterism.pattern.layout.build import layout
from benchmarks.report import markdown, write_report

STARS = ((8.0, 0.3), (8.0, 0.4), (7.0, 0.35))  # length and thickness of the arms, mm
WIDTH_MM = 1.2  # of the arms
STRAINS = (0.0, 0.02, 0.04, 0.06, 0.1)
EDGE_MM = 1.45
HEADER = ["arms, mm", "thickness, mm", "strain e", "scale", "bump, mm", "over that at e = 0", "e_0"]


def main() -> None:
    rows = [row for length, thickness in STARS for row in rows_of(length, thickness)]
    text = markdown(HEADER, [line(row) for row in rows])
    text += f"\n\nMedian of e_0: {np.nanmedian([row['e_0'] for row in rows]):.3f}"
    print(text)
    write_report("stretched_bumps", rows, text, command="python -m benchmarks.stretched_bumps")


def rows_of(length: float, thickness: float) -> list[dict[str, float]]:
    """The bumps of equal stars at each strain."""
    rows: list[dict[str, float]] = []
    for strain in STRAINS:
        design = held(length, thickness, 1.0)
        sizes = np.array([[length], [thickness], [WIDTH_MM]])
        lam = float(load_law().evaluate(design, *sizes).value["lam"][0])
        scale = lam * (1.0 + strain)
        bump = bump_mm(held(length, thickness, scale))
        share = bump / rows[0]["bump_mm"] if rows else 1.0
        rows.append(
            {"length_mm": length, "thickness_mm": thickness, "strain": strain, "scale": scale, "bump_mm": bump}
            | {"share": share, "e_0": strain / (1.0 / share - 1.0) if share < 1.0 else np.nan}
        )
    return rows


def held(length: float, thickness: float, scale: float) -> Design:
    """Seven stars on a border that is held at a scale of its printed size."""
    return Design.from_dict(
        gallery.load("tube").to_dict()
        | {
            "stars": {"length_mm": length, "thickness_mm": thickness, "width_mm": WIDTH_MM},
            "border": {"rings": 1},
            "pins": [{"where": "border", "scale": scale}],
            "mesh": {"edge_mm": EDGE_MM},
        }
    )


def bump_mm(design: Design) -> float:
    """mm, the middle star over the mean of its tips in the exact shape."""
    plan, shape = layout(design), exact_shape(design)
    middle = int(np.linalg.norm(plan.centres, axis=1).argmin())
    tips = plan.arm_tip[plan.arm_star == middle]
    return abs(float(shape.at(plan.centres[middle : middle + 1])[0, 2] - shape.at(tips)[:, 2].mean()))


def line(row: dict[str, float]) -> list[str]:
    return [
        f"{row['length_mm']:g}", f"{row['thickness_mm']:g}", f"{row['strain']:.2f}", f"{row['scale']:.3f}",
        f"{row['bump_mm']:.3f}", f"{row['share']:.2f}", f"{row['e_0']:.3f}",
    ]  # fmt: skip


if __name__ == "__main__":
    main()
