"""Random drawings, each certified by the exact model or refused in one line: lines, circles, waves and spirals.

python -m benchmarks.random_drawings [FIRST COUNT]    (a batch of seeds; by default 0 to 199, and the report)
"""

from __future__ import annotations

import sys
import time
from typing import Any

from asterism.equilibrium.errors import Error
from asterism.exact.simulation import exact_shape
from asterism.pattern.design.design import Design
from asterism.pattern.geometry.planar import triangle_angles
from asterism.pattern.layout.print_layout import print_layout
from asterism.pattern.mesh.meshing import mesh_layout
from benchmarks.report import markdown, write_report
from tests.pattern.rods.drawings import random_drawing

DRAWINGS = 200
LEAST_ANGLE_DEG = 20.0
HEADER = ["what became of the drawings", "number", "seeds"]


def main(first: int, count: int) -> None:
    rows = []
    for seed in range(first, first + count):
        rows.append(outcome(seed))
        print(rows[-1], flush=True)
    table = summary(rows)
    print(table)
    if (first, count) == (0, DRAWINGS):
        write_report("random_drawings", rows, table)


def outcome(seed: int) -> dict[str, Any]:
    """What became of one drawing."""
    before = time.process_time()
    design = Design.from_dict(random_drawing(seed))
    try:
        plan = print_layout(design)
        mesh = mesh_layout(plan, design.mesh.edge_mm)
    except Error as error:
        line = str(error)
        return {"seed": seed, "outcome": "refused" if "\n" not in line else "refused in several lines", "message": line}
    angle = float(triangle_angles(mesh.points, mesh.triangles).min())
    if angle < LEAST_ANGLE_DEG:
        return {"seed": seed, "outcome": "meshed with flat triangles", "least_angle_deg": angle}
    summary = exact_shape(design, plan=plan).summary
    return {
        "seed": seed,
        "outcome": "certified" if summary.is_minimum else "not certified",
        "least_angle_deg": angle,
        "vertices": summary.vertices,
        "smallest_eigenvalue": summary.smallest_eigenvalue,
        "processor_s": time.process_time() - before,
    }


def summary(rows: list[dict[str, Any]]) -> str:
    """The table: how many drawings have each outcome; refusals by their reason."""
    reasons = ("meet at", "apart at", "too close together", "lie on each other", "has a piece of", "at most")
    kinds: dict[str, list[int]] = {}
    for row in rows:
        message = row.get("message", "")
        reason = next((f": {each}" for each in reasons if each in message), "")
        kinds.setdefault(row["outcome"] + reason, []).append(row["seed"])
    lines = [
        [kind, str(len(seeds)), ", ".join(map(str, seeds[:8])) + (", ..." if len(seeds) > 8 else "")]
        for kind, seeds in sorted(kinds.items(), key=lambda each: -len(each[1]))
    ]
    return markdown(HEADER, lines)


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:]] or [0, DRAWINGS]
    main(*numbers)
