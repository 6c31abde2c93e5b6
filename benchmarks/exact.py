"""The exact model's cost: the paper's four timed designs, more vertices, more stars, graded meshes with the plate.

python -m benchmarks.exact [table1|vertices|stars|plate ...]

Every case runs in a process of its own, so that its memory is its own; the compiled loops are warm.
"""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import numpy as np

from asterism.exact.simulation import exact_shape
from asterism.pattern import gallery
from asterism.pattern.design.design import Design
from benchmarks.report import markdown, peak_memory_mb, write_report

# Table 1 of the paper: seconds on one thread of a Xeon Gold 5118, and vertices
PAPER = {"roof": (1047.7, 7237), "u-shape": (1702.7, 10551), "tunnel": (1437.8, 8020), "doubly-curved": (2400.4, 12140)}
# edges that make these meshes of the paper's size as closely as the aligned mesh allows
TABLE1 = {"roof": 2.12, "u-shape": 2.0, "tunnel": 2.0, "doubly-curved": 1.95}
EDGES = [17.3205 / k for k in (5, 7, 9, 12, 13, 16, 25, 36)]
PLATE_EDGES = [17.3205 / k for k in (9, 12, 16, 19, 26)]
RINGS = [3, 4, 5, 6, 7, 8]
HEADER = [
    "case", "vertices", "stars", "seconds", "ms per vertex", "coarse it/fact", "finest it/fact", "finest s: Newton",
    "certificate", "peak MB", "paper s",
]  # fmt: skip


def cases(group: str) -> list[dict[str, Any]]:
    """Designs of a group: name, entries that replace the gallery's, the paper's seconds if it has them."""
    if group == "table1":
        return [
            {"name": name, "design": name, "mesh": {"edge_mm": edge}, "paper_s": PAPER[name][0]}
            for name, edge in TABLE1.items()
        ]
    if group == "vertices":
        return [{"name": f"tube, edge {e:.2f} mm", "design": "tube", "mesh": {"edge_mm": e}} for e in EDGES]
    if group == "plate":
        plate = {"bending": "consistent"}
        return [
            {
                "name": f"graded tube, edge {e:.2f} mm",
                "design": "tube",
                "mesh": {"edge_mm": e, "graded": True},
                "fabric": plate,
            }
            for e in PLATE_EDGES
        ]
    return [{"name": f"tube, {n} rings", "design": "tube", "border": {"rings": n}} for n in RINGS]


def run(case: dict[str, Any]) -> dict[str, Any]:
    """One case, here and now."""
    data = gallery.load(case["design"]).to_dict()
    for section in ("mesh", "border", "fabric"):
        data[section] = data[section] | case.get(section, {})
    summary = dict(exact_shape(Design.from_dict(data)).summary)
    del summary["design"]
    return case | summary | {"peak_mb": peak_memory_mb()}


def row(r: dict[str, Any]) -> list[str]:
    """One line of the table."""
    *coarse, finest = r["levels"]
    work = f"{sum(c['iterations'] for c in coarse)}/{sum(c['factorisations'] for c in coarse)}" if coarse else "-"
    seconds = finest["seconds"]
    newton = sum(seconds.get(stage, 0.0) for stage in ("release", "equilibrium", "saddle"))
    return [
        r["name"] + ("" if r["is_minimum"] else " (no minimum)"),
        str(r["vertices"]),
        str(r["stars_total"]),
        f"{r['wall_s']:.1f}",
        f"{1000 * r['wall_s'] / r['vertices']:.2f}",
        work,
        f"{finest['iterations']}/{finest['factorisations']}",
        f"{newton:.1f}",
        f"{seconds['certificate']:.1f}",
        f"{r['peak_mb']:.0f}",
        f"{r['paper_s']:.0f}" if "paper_s" in r else "-",
    ]


def main(words: list[str]) -> None:
    if words[:1] == ["--case"]:
        print(json.dumps(run(json.loads(words[1]))))
        return
    groups = words or ["table1", "vertices", "stars", "plate"]
    rows: list[dict[str, Any]] = []
    tables: list[str] = []
    run({"name": "warm up", "design": "star"})
    for group in groups:
        found = []
        for case in cases(group):
            command = [sys.executable, "-m", "benchmarks.exact", "--case", json.dumps(case)]
            out = subprocess.run(command, capture_output=True, text=True, check=True).stdout
            found.append(json.loads(out.splitlines()[-1]) | {"group": group})
            print("  ".join(row(found[-1])), flush=True)
        rows += found
        title = markdown(HEADER, [row(r) for r in found])
        size, seconds = np.log([r["vertices"] for r in found]), np.log([r["wall_s"] for r in found])
        if group != "table1":
            title += (
                f"\n\nSeconds grow like vertices to the power {np.polyfit(size, seconds, 1)[0]:.2f} over this range."
            )
            print(title.splitlines()[-1])
        tables.append(f"### {group}\n\n{title}")
    if not words:
        write_report("exact", rows, "\n\n".join(tables))


if __name__ == "__main__":
    main(sys.argv[1:])
