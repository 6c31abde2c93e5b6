"""Free rims of endless ribbons in the exact model: how far the bare fabric turns beyond the last stars, and where.

python -m benchmarks.ribbon_cells

A ribbon of equal stars has two free sides. It rolls along its length under one screw motion, and one period of it is
solved (`homogenize.cell.ribbon_cell`). The mean of a grid line over the period gives the section across: radius about
the axis over place along the axis. The slope of the section is taken at the last line of stars, just beyond the tips of
their arms, and at the side. Bare fabric goes straight on if the last two are the same. The preview turns its rims by
`2 B / l` (`asterism.previews.edges.free_rim`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from asterism.equilibrium.arrays import Floats
from asterism.equilibrium.threads import one_blas_thread
from asterism.homogenize.cell.ribbon_cell import RibbonCell, cylinder_coordinates, relax_ribbon
from asterism.homogenize.cell.ribbon_mesh import RibbonShape
from asterism.pattern.design.design import Design
from asterism.pattern.design.lattice import DEFAULT_SPACING_MM
from asterism.pattern.layout.build import layout
from asterism.previews.default_law import paper_law
from asterism.previews.fields.star_values import star_values
from benchmarks.report import markdown, write_report

STEPS = 15  # mesh edges from star to star, as in the study
# sides across a lattice direction, lines of stars, rim in grid steps, arm in mesh edges, thickness mm
RIBBONS = [
    (False, 1, 10, 5, 0.3), (False, 1, 18, 5, 0.3), (False, 3, 10, 5, 0.3), (False, 1, 10, 8, 0.3),
    (False, 1, 10, 5, 0.43), (False, 1, 18, 5, 0.43),
    (True, 2, 16, 5, 0.3), (True, 5, 26, 5, 0.3), (True, 2, 16, 8, 0.3), (True, 2, 16, 5, 0.43),
]  # fmt: skip
HEADER = [
    "sides", "lines of stars", "rim mm", "l mm", "h mm", "curvature along 1/mm", "slope at the last stars",
    "beyond the tips", "at the side", "turn", "2 B / l", "minimum",
]  # fmt: skip

Row = dict[str, Any]


@one_blas_thread()
def main() -> None:
    rows = []
    for ribbon in RIBBONS:
        rows.append(measured(*ribbon))
        print(rows[-1], flush=True)
    text = f"{markdown(HEADER, [_line(row) for row in rows])}\n\nSlopes are means of both sides, positive downwards."
    print(text)
    write_report("ribbon_cells", rows, text)


def measured(across: bool, lines: int, rim: int, arm: int, thickness: float) -> Row:
    """Curvature along a ribbon and the slopes across it."""
    edge = DEFAULT_SPACING_MM / STEPS
    stars = {"length_mm": arm * edge, "thickness_mm": thickness}
    design = Design.from_dict({"stars": stars, "border": {"rings": 1}, "mesh": {"edge_mm": edge}})
    cell = RibbonCell(design, RibbonShape(across, lines, rim, STEPS, arm))
    ribbon = relax_ribbon(cell)
    radius, along, _, _ = cylinder_coordinates(cell, ribbon.state)
    printed = cell.printed_across()
    line = np.unique(printed.round(6), return_inverse=True)
    section = np.array([np.bincount(line[1], of) / np.bincount(line[1]) for of in (radius, along)])
    step = edge * (0.5 if across else np.sqrt(0.75))
    # the arms at a right angle or at 60 degrees to the side reach furthest
    reach = arm * (1.0 if not across else 2.0)
    places = [0.0, min(reach + 1.0, rim - 2.0) * step, (rim - 1.0) * step]
    slopes = _slopes(section, line[0], (lines - 1) * STEPS * step, np.array(places), step)
    values = star_values(design, layout(design), paper_law())
    return {
        "sides": "across" if across else "along",
        "lines": lines,
        "rim_mm": rim * step,
        "length_mm": arm * edge,
        "thickness_mm": thickness,
        "curvature_per_mm": ribbon.curvature,
        "slopes": slopes.tolist(),
        "turn": float(slopes[2] - slopes[0]),
        "tip_slope": float(values.tip_slope[0]),
        "is_minimum": ribbon.definite,
    }


def _slopes(section: Floats, printed: Floats, last: float, beyond: Floats, step: float) -> Floats:
    """(n,) slopes of the section (2, m) at these distances beyond the last stars, mean of both sides, downwards."""
    out = np.zeros(len(beyond))
    for place, sign in ((last + beyond, -1.0), (-beyond, 1.0)):
        fine, coarse = (np.array([np.interp(place + shift, printed, of) for of in section]) for shift in (step, -step))
        drop, run = fine - coarse
        out += 0.5 * sign * drop / run
    return out


def _line(row: Row) -> list[str]:
    return [
        row["sides"],
        str(row["lines"]),
        *(f"{row[key]:.1f}" for key in ("rim_mm", "length_mm")),
        f"{row['thickness_mm']:.2f}",
        f"{row['curvature_per_mm']:.4f}",
        *(f"{slope:.2f}" for slope in row["slopes"]),
        f"{row['turn']:.2f}",
        f"{row['tip_slope']:.2f}",
        "yes" if row["is_minimum"] else "no",
    ]


if __name__ == "__main__":
    main()
