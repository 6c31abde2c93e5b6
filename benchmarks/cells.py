"""Unit cells: what a sample costs.

python -m benchmarks.cells
"""

from __future__ import annotations

import statistics
import time
from typing import Any

from benchmarks.report import markdown, write_report
from homogenize.sample import respond
from pattern.design import Design

SIZES = ((10.0, 0.4), (10.0, 0.6), (7.0, 0.3))  # length and thickness, mm
EDGES = (2.1, 1.15)
RUNS = 3


def main() -> None:
    respond(sheet(5.0, 0.4), 2.1)  # compiles
    costs = [cost(length, thickness, edge) for length, thickness in SIZES for edge in EDGES]
    text = f"Seconds of one sample by part, median of {RUNS}:\n\n{cost_table(costs)}"
    write_report("cells", costs, text)
    print(text)


def sheet(length: float, thickness: float) -> Design:
    """Equal stars of the paper's material."""
    return Design.from_dict({"stars": {"length_mm": length, "thickness_mm": thickness}, "border": {"rings": 1}})


def cost(length: float, thickness: float, edge: float) -> dict[str, Any]:
    """Median seconds of a sample by part."""
    runs = []
    for _ in range(RUNS):
        start = time.perf_counter()
        sample = respond(sheet(length, thickness), edge)
        runs.append(sample.seconds | {"all": time.perf_counter() - start})
    seconds = {part: statistics.median(run[part] for run in runs) for part in runs[0]}
    return {
        "length_mm": length, "thickness_mm": thickness, "edge_mm": edge, "vertices": sample.vertices,
        "iterations": sample.iterations, "seconds": seconds,
    }  # fmt: skip


def cost_table(rows: list[dict[str, Any]]) -> str:
    parts = list(dict.fromkeys(part for row in rows for part in row["seconds"]))
    table = [
        [
            f"h {r['thickness_mm']:g}, l {r['length_mm']:g}",
            f"{r['edge_mm']:g}",
            str(r["vertices"]),
            str(r["iterations"]),
        ]
        + [f"{r['seconds'].get(part, 0.0):.2f}" for part in parts]
        for r in rows
    ]
    return markdown(["star, mm", "edge mm", "vertices", "iterations", *(f"{part} s" for part in parts)], table)


if __name__ == "__main__":
    main()
